#include "boundary_path/path_topology.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <atomic>

namespace selvage {

namespace {

/// The ridges of an element, each followed by its complement, as even permutations of the element's vertices.
constexpr int kTetRidges[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};
constexpr int kTriangleRidges[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};

template <int D>
auto& ridges_of_element() {
  if constexpr (D == 3)
    return kTetRidges;
  else
    return kTriangleRidges;
}

template <int D>
Index neighbour_behind(const SimplexMesh<D>& mesh, Index element, Index vertex) {
  const auto& vertices = mesh.elements()[element];
  return mesh.neighbours()[element][std::find(vertices.begin(), vertices.end(), vertex) - vertices.begin()];
}

/// Turns around the ridge whose complement in `start` is (from, to). False on the boundary, or when an element with a
/// smaller index is met, which then is the one to list the ridge.
template <int D>
bool collect_interior_link(const SimplexMesh<D>& mesh, Index start, Index from, Index to, std::vector<Index>& link) {
  link.assign({from, to});
  Index element = start, behind = from, apex = to;
  for (;;) {
    const Index across = neighbour_behind(mesh, element, behind);
    if (across < 0) return false;
    element = HalfFace{across}.element();
    if (element == start) break;
    if (element < start) return false;
    behind = apex;
    apex = mesh.elements()[element][HalfFace{across}.face()];
    link.push_back(apex);
  }
  link.pop_back();  // the last element leads back to `from`
  return true;
}

/// Breadth first from the boundary inward.
template <int D>
std::vector<Index> nearest_boundary_faces(const SimplexMesh<D>& mesh) {
  std::vector<Index> nearest(mesh.element_count(), kNone);
  std::vector<Index> front;
  for (Index b = 0; b < mesh.boundary_face_count(); ++b) {
    const Index owner = mesh.boundary_owners()[b].element();
    if (nearest[owner] != kNone) continue;
    nearest[owner] = b;
    front.push_back(owner);
  }
  for (std::size_t i = 0; i < front.size(); ++i) {
    for (Index across : mesh.neighbours()[front[i]]) {
      if (across < 0 || nearest[HalfFace{across}.element()] != kNone) continue;
      nearest[HalfFace{across}.element()] = nearest[front[i]];
      front.push_back(HalfFace{across}.element());
    }
  }
  return nearest;
}

/// From boundary face to boundary face around the ridge opposite to a corner of the first, that corner first.
template <int D>
void collect_boundary_link(const SimplexMesh<D>& mesh, Index face, int corner, std::vector<Index>& link) {
  Index element = mesh.boundary_owners()[face].element();
  Index apex = mesh.elements()[element][mesh.boundary_owners()[face].face()];
  Index behind = mesh.boundary_faces()[face][corner];
  link.assign({behind, apex});
  for (;;) {
    const Index across = neighbour_behind(mesh, element, behind);
    if (across < 0) return;
    behind = apex;
    element = HalfFace{across}.element();
    apex = mesh.elements()[element][HalfFace{across}.face()];
    link.push_back(apex);
  }
}

template <int D>
void append_fans(typename PathTopology<D>::Fans& all, typename PathTopology<D>::Fans& piece) {
  for (auto& fan : piece.fans) {
    fan.first_link += std::ssize(all.links);
    all.fans.push_back(fan);
  }
  all.links.insert(all.links.end(), piece.links.begin(), piece.links.end());
  piece = {};
}

/// Lists fans piece by piece in parallel, in order: `collect(item, link, add)` calls add(ridge, element). Without the
/// sentinel.
template <int D, typename Collect>
typename PathTopology<D>::Fans collect_fans(std::int64_t items, Collect&& collect) {
  using Fans = typename PathTopology<D>::Fans;
  constexpr std::int64_t kItemsAtOnce = 1 << 14;
  std::vector<Fans> pieces((items + kItemsAtOnce - 1) / kItemsAtOnce);
  parallel_for(std::ssize(pieces), 1, [&](std::int64_t k) {
    std::vector<Index> link;
    const auto add = [&](const VertexTuple<D - 1>& ridge, Index element) {
      pieces[k].fans.push_back({ridge, element, std::ssize(pieces[k].links)});
      pieces[k].links.insert(pieces[k].links.end(), link.begin(), link.end());
    };
    for (std::int64_t i = k * kItemsAtOnce; i < std::min((k + 1) * kItemsAtOnce, items); ++i)
      collect(static_cast<Index>(i), link, add);
  });
  Fans all;
  for (Fans& piece : pieces) append_fans<D>(all, piece);
  return all;
}

/// Those with all vertices on the boundary (`spanning`), or the others.
template <int D>
typename PathTopology<D>::Fans collect_interior_fans(const SimplexMesh<D>& mesh,
                                                     std::span<const std::uint8_t> is_on_boundary, bool spanning) {
  constexpr std::size_t kFewest = 5;
  return collect_fans<D>(mesh.element_count(), [&](Index e, std::vector<Index>& link, auto&& add) {
    const auto& v = mesh.elements()[e];
    for (const auto& r : ridges_of_element<D>()) {
      VertexTuple<D - 1> ridge;
      for (int i = 0; i < D - 1; ++i) ridge[i] = v[r[i]];
      if (std::all_of(ridge.begin(), ridge.end(), [&](Index w) { return is_on_boundary[w] != 0; }) != spanning)
        continue;
      if (!collect_interior_link(mesh, e, v[r[D - 1]], v[r[D]], link) || link.size() < kFewest) continue;
      add(ridge, e);
    }
  });
}

template <int D>
typename PathTopology<D>::Fans collect_boundary_fans(const SimplexMesh<D>& mesh) {
  constexpr std::size_t kFewest = 4;  // link vertices of three elements
  return collect_fans<D>(mesh.boundary_face_count(), [&](Index b, std::vector<Index>& link, auto&& add) {
    for (int k = 0; k < D; ++k) {
      if (mesh.boundary_neighbours()[b][k] < b) continue;
      collect_boundary_link(mesh, b, k, link);
      if (link.size() < kFewest) continue;
      const auto& f = mesh.boundary_faces()[b];
      if constexpr (D == 3) {  // the link turns counter-clockwise against the face's own order
        add({f[(k + 2) % 3], f[(k + 1) % 3]}, mesh.boundary_owners()[b].element());
      } else {  // and from the next vertex inward, not from the one before
        if (k == 0) std::reverse(link.begin(), link.end());
        add({f[1 - k]}, mesh.boundary_owners()[b].element());
      }
    }
  });
}

/// Whether the elements of a vertex do not all reach each other across faces at the vertex.
template <int D>
bool is_torn(const SimplexMesh<D>& mesh, Index v) {
  const auto star = mesh.vertex_elements(v);
  if (star.size() < 2) return false;
  std::vector<Index> reached{star.front()};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (int k = 0; k <= D; ++k) {
      const Index across = mesh.neighbours()[reached[i]][k];
      if (across < 0 || mesh.elements()[reached[i]][k] == v) continue;
      if (std::find(reached.begin(), reached.end(), HalfFace{across}.element()) == reached.end())
        reached.push_back(HalfFace{across}.element());
    }
  }
  return reached.size() != star.size();
}

template <int D>
std::vector<std::uint8_t> find_split_vertices(const SimplexMesh<D>& mesh) {
  std::vector<std::uint8_t> is_split(mesh.vertex_count(), 0);
  parallel_for(std::ssize(mesh.boundary_vertices()), 1024, [&](std::int64_t i) {
    const Index v = mesh.boundary_vertices()[i];
    is_split[v] = is_torn(mesh, v);
    if constexpr (D == 3) {
      // A manifold boundary has two faces on each edge of the vertex.
      std::vector<Index> rim;
      for (Index face : mesh.vertex_boundary_faces(v))
        for (Index w : mesh.boundary_faces()[face])
          if (w != v) rim.push_back(w);
      std::sort(rim.begin(), rim.end());
      for (std::size_t k = 0; k + 2 < rim.size(); ++k) is_split[v] |= rim[k] == rim[k + 2];
    }
  });
  return is_split;
}

/// Whether two lists of the same vertices differ by an odd permutation.
bool is_odd(const VertexTuple<2>& a, const VertexTuple<2>& b) {
  return a[0] != b[0];
}
bool is_odd(const VertexTuple<3>& a, const VertexTuple<3>& b) {
  const auto first = std::find(b.begin(), b.end(), a[0]) - b.begin();
  return b[(first + 1) % 3] != a[1];
}

template <int D>
bool has_one_orientation(const SimplexMesh<D>& mesh) {
  std::atomic<bool> good = true;
  parallel_for(mesh.element_count(), kGrain, [&](std::int64_t e) {
    for (int i = 0; i <= D; ++i) {
      const HalfFace across{mesh.neighbours()[e][i]};
      if (across.exists() &&
          !is_odd(mesh.face_of(mesh.elements()[e], i), mesh.face_of(mesh.elements()[across.element()], across.face())))
        good.store(false, std::memory_order_relaxed);
    }
  });
  return good;
}

template <int D>
std::vector<PathElement<D>> list_elements(const SimplexMesh<D>& mesh) {
  std::vector<PathElement<D>> elements(mesh.element_count());
  parallel_for(std::ssize(elements), kGrain, [&](std::int64_t e) {
    elements[e] = {mesh.elements()[e], mesh.neighbours()[e]};
  });
  return elements;
}

template <int D>
std::vector<FaceStar<D>> list_face_stars(const SimplexMesh<D>& mesh, std::span<const Index> component_of) {
  std::vector<FaceStar<D>> stars(mesh.boundary_face_count());
  parallel_for(std::ssize(stars), kGrain, [&](std::int64_t b) {
    FaceStar<D>& star = stars[b];
    star.vertices = mesh.boundary_faces()[b];
    star.component = component_of[mesh.boundary_owners()[b].element()];
    for (int k = 0; k < D; ++k) {
      const VertexTuple<D>& other = mesh.boundary_faces()[mesh.boundary_neighbours()[b][k]];
      star.apexes[k] = *std::find_if(other.begin(), other.end(), [&](Index v) {
        return v == star.vertices[k] || std::find(star.vertices.begin(), star.vertices.end(), v) == star.vertices.end();
      });
    }
  });
  return stars;
}

template <int D>
std::vector<std::uint8_t> find_boundary(const SimplexMesh<D>& mesh) {
  std::vector<std::uint8_t> is_on_boundary(mesh.vertex_count(), 0);
  for (Index v : mesh.boundary_vertices()) is_on_boundary[v] = 1;
  return is_on_boundary;
}

}  // namespace

template <int D>
PathTopology<D>::PathTopology(const SimplexMesh<D>& mesh)
    : component_of(mesh.element_components()),
      component_count(*std::max_element(component_of.begin(), component_of.end()) + 1),
      hints(nearest_boundary_faces(mesh)),
      elements(list_elements(mesh)),
      face_stars(list_face_stars(mesh, component_of)),
      is_split(find_split_vertices(mesh)),
      is_on_boundary(find_boundary(mesh)),
      is_oriented(has_one_orientation(mesh)),
      interior_fans(collect_interior_fans(mesh, is_on_boundary, true)),
      boundary_fans(collect_boundary_fans(mesh)),
      rims(mesh) {
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    inner_vertex_count += is_on_boundary[v] == 0 && !mesh.vertex_elements(v).empty();
  spanning_count = std::ssize(interior_fans.fans);
  Fans others = collect_interior_fans(mesh, is_on_boundary, false);
  append_fans<D>(interior_fans, others);
  for (Fans* fans : {&interior_fans, &boundary_fans}) fans->fans.push_back({{}, kNone, std::ssize(fans->links)});
}

template struct PathTopology<2>;
template struct PathTopology<3>;

}  // namespace selvage
