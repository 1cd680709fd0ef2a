#include "selvage/mesh/simplex_mesh.h"

#include "mesh/tuple_check.h"
#include "mesh/vertex_stars.h"
#include "selvage/core/error.h"
#include "selvage/core/parallel.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

namespace {

template <int N>
int local_index(const VertexTuple<N>& tuple, Index vertex) {
  return static_cast<int>(std::find(tuple.begin(), tuple.end(), vertex) - tuple.begin());
}

/// Calls visit(element, local face) for every other element that has all the vertices of `face`.
template <int D, typename Visit>
void for_each_across(std::span<const VertexTuple<D + 1>> elements, std::span<const Index> candidates, Index self,
                     const VertexTuple<D>& face, Visit&& visit) {
  for (Index other : candidates) {
    if (other == self) continue;
    const auto& vertices = elements[other];
    int apex = -1, shared = 0;
    for (int i = 0; i <= D; ++i) {
      if (std::find(face.begin(), face.end(), vertices[i]) != face.end())
        ++shared;
      else
        apex = i;
    }
    if (shared == D) visit(other, apex);
  }
}

}  // namespace

template <int D>
SimplexMesh<D>::SimplexMesh(Index vertex_count, std::vector<Element> elements)
    : vertex_count_(vertex_count), elements_(std::move(elements)) {
  check_tuples<D + 1>(vertex_count_, elements_, "element");
  build_vertex_stars<D + 1>(vertex_count_, elements_, vertex_element_, vertex_element_first_);
  find_neighbours();
  list_boundary();
  link_boundary();
}

template <int D>
void SimplexMesh<D>::find_neighbours() {
  neighbours_.resize(elements_.size());
  FirstOffender crowded("element");
  parallel_for(element_count(), kGrain, [&](std::int64_t e) {
    const Index self = static_cast<Index>(e);
    for (int i = 0; i <= D; ++i) {
      const Face face = face_of(elements_[e], i);
      // The vertex with the smallest star leaves the fewest elements to look at.
      const Index rarest = *std::min_element(face.begin(), face.end(), [&](Index a, Index b) {
        return vertex_elements(a).size() < vertex_elements(b).size();
      });
      int found = 0;
      neighbours_[e][i] = kNone;
      for_each_across<D>(elements_, vertex_elements(rarest), self, face, [&](Index other, int apex) {
        neighbours_[e][i] = HalfFace::of(other, apex).code;
        ++found;
      });
      if (found > 1) crowded.report(self);
    }
  });
  if (crowded.any())
    throw Error(crowded.name(), "shares a face with two or more other elements",
                "a face may belong to two elements at most: remove doubled elements");
}

template <int D>
void SimplexMesh<D>::list_boundary() {
  for (Index e = 0; e < element_count(); ++e) {
    for (int i = 0; i <= D; ++i) {
      if (neighbours_[e][i] != kNone) continue;
      neighbours_[e][i] = ~boundary_face_count();
      boundary_faces_.push_back(face_of(elements_[e], i));
      boundary_owners_.push_back(HalfFace::of(e, i));
    }
  }
  build_vertex_stars<D>(vertex_count_, boundary_faces_, vertex_boundary_face_, vertex_boundary_face_first_);
  for (Index v = 0; v < vertex_count_; ++v)
    if (!vertex_boundary_faces(v).empty()) boundary_vertices_.push_back(v);
}

template <int D>
void SimplexMesh<D>::link_boundary() {
  boundary_neighbours_.resize(boundary_faces_.size());
  parallel_for(boundary_face_count(), kGrain, [&](std::int64_t b) {
    for (int k = 0; k < D; ++k) {
      Index element = boundary_owners_[b].element();
      Index apex = elements_[element][boundary_owners_[b].face()];
      Index behind = boundary_faces_[b][k];  // the vertex that the turn around the ridge leaves behind
      for (;;) {
        const Index across = neighbours_[element][local_index<D + 1>(elements_[element], behind)];
        if (across < 0) {
          boundary_neighbours_[b][k] = ~across;
          break;
        }
        behind = apex;
        element = HalfFace{across}.element();
        apex = elements_[element][HalfFace{across}.face()];
      }
    }
  });
}

template <int D>
std::vector<BoundaryRidge<D>> SimplexMesh<D>::boundary_ridges() const {
  std::vector<BoundaryRidge<D>> ridges;
  for (Index b = 0; b < boundary_face_count(); ++b) {
    for (int k = 0; k < D; ++k) {
      const Index other = boundary_neighbours_[b][k];
      if (other < b) continue;
      BoundaryRidge<D> ridge;
      for (int i = 0, n = 0; i < D; ++i)
        if (i != k) ridge.vertices[n++] = boundary_faces_[b][i];
      std::sort(ridge.vertices.begin(), ridge.vertices.end());
      ridge.faces = {b, other};
      ridges.push_back(ridge);
    }
  }
  return ridges;
}

template <int D>
std::vector<Index> SimplexMesh<D>::element_components() const {
  std::vector<Index> component(elements_.size(), kNone);
  std::vector<Index> pending;
  Index count = 0;
  for (Index seed = 0; seed < element_count(); ++seed) {
    if (component[seed] != kNone) continue;
    component[seed] = count;
    pending.assign(1, seed);
    while (!pending.empty()) {
      const Index e = pending.back();
      pending.pop_back();
      for (Index across : neighbours_[e]) {
        if (across < 0) continue;
        Index& mark = component[HalfFace{across}.element()];
        if (mark != kNone) continue;
        mark = count;
        pending.push_back(HalfFace{across}.element());
      }
    }
    ++count;
  }
  return component;
}

template class SimplexMesh<2>;
template class SimplexMesh<3>;

}  // namespace selvage
