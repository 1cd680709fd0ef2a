#include "selvage/mesh/simplex_mesh.h"

#include "core/parallel.h"
#include "core/union_find.h"
#include "mesh/tuple_check.h"
#include "mesh/vertex_stars.h"
#include "selvage/core/error.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace selvage {

namespace {

constexpr std::int64_t kVerticesAtOnce = 512;

template <int N>
int local_index(const VertexTuple<N>& tuple, Index vertex) {
  return static_cast<int>(std::find(tuple.begin(), tuple.end(), vertex) - tuple.begin());
}

/// A face of an element, seen from its smallest vertex.
struct OutlinedFace {
  std::uint64_t others;  ///< its other vertices
  Index half_face;
};

template <int D>
OutlinedFace outline_face(const VertexTuple<D + 1>& element, Index e, int face, Index smallest) {
  std::uint32_t low = 0, high = 0;
  for (int i = 0; i <= D; ++i)
    if (i != face && element[i] != smallest) {
      const auto vertex = static_cast<std::uint32_t>(element[i]);
      low = high == 0 ? vertex : std::min(high, vertex);
      high = std::max(high, vertex);
    }
  return {static_cast<std::uint64_t>(high) << 32 | low, HalfFace::of(e, face).code};
}

/// Visits the faces whose smallest vertex is v: those of elements whose smallest vertex it is, and one of each element
/// in which it comes second.
template <int D, typename Visit>
void visit_faces(const SimplexMesh<D>& mesh, Index v, Visit&& visit) {
  for (const Index e : mesh.vertex_elements(v)) {
    const auto& element = mesh.elements()[e];
    int smaller = 0, last_smaller = 0;
    for (int i = 0; i <= D; ++i)
      if (element[i] < v) {
        ++smaller;
        last_smaller = i;
      }
    if (smaller == 1) visit(outline_face<D>(element, e, last_smaller, v));
    if (smaller > 0) continue;
    for (int i = 0; i <= D; ++i)
      if (element[i] != v) visit(outline_face<D>(element, e, i, v));
  }
}

/// The faces of one vertex after the other, each found by its other vertices: a hash table that need not be cleared.
class FaceTable {
 public:
  struct Entry {
    std::uint64_t others;
    Index vertex = kNone;
    Index first;             ///< the half-face that came first
    bool is_paired = false;  ///< a second has come
  };

  /// @param most_faces  that the vertex can have
  void begin(Index vertex, std::size_t most_faces) {
    vertex_ = vertex;
    const std::size_t size = std::bit_ceil(2 * most_faces + 1);
    if (size > entries_.size()) entries_.assign(size, {});
    mask_ = size - 1;
  }

  /// The face's entry; a new one when none has come that is the same.
  Entry& find(const OutlinedFace& face) {
    for (std::size_t i = hash(face.others);; ++i) {
      Entry& entry = entries_[i & mask_];
      if (entry.vertex != vertex_) return entry = {face.others, vertex_, face.half_face};
      if (entry.others == face.others) return entry;
    }
  }

 private:
  static std::size_t hash(std::uint64_t others) { return others * 0x9E3779B97F4A7C15u >> 32; }

  std::vector<Entry> entries_;
  std::size_t mask_ = 0;
  Index vertex_ = kNone;
};

}  // namespace

template <int D>
SimplexMesh<D>::SimplexMesh(Index vertex_count, std::vector<Element> elements)
    : vertex_count_(vertex_count), elements_(std::move(elements)) {
  check_tuples<D + 1>(vertex_count_, elements_, "element");
  build();
}

template <int D>
SimplexMesh<D> SimplexMesh<D>::without_elements(Index vertex_count) {
  SimplexMesh mesh;
  mesh.vertex_count_ = vertex_count;
  mesh.build();
  return mesh;
}

template <int D>
void SimplexMesh<D>::build() {
  build_vertex_stars<D + 1>(vertex_count_, elements_, vertex_element_, vertex_element_first_);
  find_neighbours();
  list_boundary();
  link_boundary();
}

template <int D>
void SimplexMesh<D>::find_neighbours() {
  neighbours_.resize(elements_.size());
  FirstOffender crowded("element");
  parallel_ranges(vertex_count_, kVerticesAtOnce, [&](std::int64_t begin, std::int64_t end) {
    FaceTable faces;
    for (Index v = static_cast<Index>(begin); v < end; ++v) {
      faces.begin(v, D * vertex_elements(v).size());
      visit_faces(*this, v, [&](const OutlinedFace& face) {
        FaceTable::Entry& entry = faces.find(face);
        const HalfFace half{face.half_face}, first{entry.first};
        const bool is_first = half.code == first.code;
        neighbours_[half.element()][half.face()] = is_first ? HalfFace() : first;
        if (is_first) return;
        neighbours_[first.element()][first.face()] = half;
        if (entry.is_paired) crowded.report(first.element());
        entry.is_paired = true;
      });
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
      if (neighbours_[e][i].exists()) continue;
      neighbours_[e][i] = HalfFace::at_boundary(boundary_face_count());
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
        const HalfFace across = neighbours_[element][local_index<D + 1>(elements_[element], behind)];
        if (!across.exists()) {
          boundary_neighbours_[b][k] = across.boundary_face();
          break;
        }
        behind = apex;
        element = across.element();
        apex = elements_[element][across.face()];
      }
    }
  });
}

template <int D>
std::vector<VertexTuple<2>> SimplexMesh<D>::edges() const {
  const std::int64_t pieces = (vertex_count_ + kVerticesAtOnce - 1) / kVerticesAtOnce;
  std::vector<std::vector<VertexTuple<2>>> of_piece(pieces);
  parallel_for(pieces, 1, [&](std::int64_t piece) {
    const auto end = static_cast<Index>(std::min<std::int64_t>((piece + 1) * kVerticesAtOnce, vertex_count_));
    std::vector<Index> others;
    for (auto v = static_cast<Index>(piece * kVerticesAtOnce); v < end; ++v) {
      others.clear();
      for (const Index e : vertex_elements(v))
        for (const Index other : elements_[e])
          if (other > v) others.push_back(other);
      std::sort(others.begin(), others.end());
      others.erase(std::unique(others.begin(), others.end()), others.end());
      for (const Index other : others) of_piece[piece].push_back({v, other});
    }
  });
  std::size_t count = 0;
  for (const auto& some : of_piece) count += some.size();
  std::vector<VertexTuple<2>> edges;
  edges.reserve(count);
  for (const auto& some : of_piece) edges.insert(edges.end(), some.begin(), some.end());
  return edges;
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

/// By union of sets in which each element points to a smaller one of its component: element after element, so that
/// memory is read in order.
template <int D>
std::vector<Index> SimplexMesh<D>::element_components() const {
  UnionFind components(elements_.size());
  for (Index e = 0; e < element_count(); ++e)
    for (const HalfFace across : neighbours_[e])
      if (across.exists() && across.element() < e) components.join(across.element(), e);
  return components.numbered();
}

template class SimplexMesh<2>;
template class SimplexMesh<3>;

}  // namespace selvage
