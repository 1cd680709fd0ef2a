#include "boundary_path/input/path_topology.h"

#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <mutex>

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
HalfFace neighbour_behind(const SimplexMesh<D>& mesh, Index element, Index vertex) {
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
    const HalfFace across = neighbour_behind(mesh, element, behind);
    if (!across.exists()) return false;
    element = across.element();
    if (element == start) break;
    if (element < start) return false;
    behind = apex;
    apex = mesh.elements()[element][across.face()];
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
    for (const HalfFace across : mesh.neighbours()[front[i]]) {
      if (!across.exists() || nearest[across.element()] != kNone) continue;
      nearest[across.element()] = nearest[front[i]];
      front.push_back(across.element());
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
    const HalfFace across = neighbour_behind(mesh, element, behind);
    if (!across.exists()) return;
    behind = apex;
    element = across.element();
    apex = mesh.elements()[element][across.face()];
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

/// Fans of some kinds, one kind after the other, without the sentinel; and where each kind ends.
template <int D, int kKinds>
struct SortedFans {
  typename PathTopology<D>::Fans all;
  std::array<std::int64_t, kKinds> ends;
};

/// Lists fans piece by piece in parallel, in order: `collect(item, link, add)` calls add(kind, ridge, element).
template <int D, int kKinds, typename Collect>
SortedFans<D, kKinds> collect_fans(std::int64_t items, Collect&& collect) {
  constexpr std::int64_t kItemsAtOnce = 1 << 14;
  using Pieces = std::vector<typename PathTopology<D>::Fans>;
  std::array<Pieces, kKinds> pieces;
  pieces.fill(Pieces((items + kItemsAtOnce - 1) / kItemsAtOnce));
  parallel_for(std::ssize(pieces[0]), 1, [&](std::int64_t k) {
    std::vector<Index> link;
    const auto add = [&](int kind, const VertexTuple<D - 1>& ridge, Index element) {
      auto& piece = pieces[kind][k];
      piece.fans.push_back({ridge, element, std::ssize(piece.links)});
      piece.links.insert(piece.links.end(), link.begin(), link.end());
    };
    for (std::int64_t i = k * kItemsAtOnce; i < std::min((k + 1) * kItemsAtOnce, items); ++i)
      collect(static_cast<Index>(i), link, add);
  });
  SortedFans<D, kKinds> sorted;
  for (int kind = 0; kind < kKinds; ++kind) {
    for (auto& piece : pieces[kind]) append_fans<D>(sorted.all, piece);
    sorted.ends[kind] = std::ssize(sorted.all.fans);
  }
  return sorted;
}

template <int D>
bool is_boundary_ridge(const SimplexMesh<D>& mesh, const VertexTuple<D - 1>& ridge) {
  const std::span<const Index> faces = mesh.vertex_boundary_faces(ridge[0]);
  return std::any_of(faces.begin(), faces.end(), [&](Index face) {
    const auto& vertices = mesh.boundary_faces()[face];
    return std::all_of(ridge.begin(), ridge.end(),
                       [&](Index v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); });
  });
}

/// First those with all vertices on the boundary, then the others.
/// @param is_split  set where elements all around a ridge meet others for which it is on the boundary
template <int D>
SortedFans<D, 2> collect_interior_fans(const SimplexMesh<D>& mesh, std::span<const std::uint8_t> is_on_boundary,
                                       std::span<std::uint8_t> is_split) {
  constexpr std::size_t kMinLinkSize = 5;
  return collect_fans<D, 2>(mesh.element_count(), [&](Index e, std::vector<Index>& link, auto&& add) {
    const auto& v = mesh.elements()[e];
    std::array<bool, D + 1> may_lead;  // the face opposite to each vertex, to an element with a larger index
    for (int i = 0; i <= D; ++i) {
      const HalfFace across = mesh.neighbours()[e][i];
      may_lead[i] = across.exists() && across.element() > e;
    }
    for (const auto& r : ridges_of_element<D>()) {
      if (!may_lead[r[D - 1]] || !may_lead[r[D]]) continue;
      if (!collect_interior_link(mesh, e, v[r[D - 1]], v[r[D]], link)) continue;
      VertexTuple<D - 1> ridge;
      for (int i = 0; i < D - 1; ++i) ridge[i] = v[r[i]];
      const bool spans = std::all_of(ridge.begin(), ridge.end(), [&](Index w) { return is_on_boundary[w] != 0; });
      if (spans && is_boundary_ridge(mesh, ridge))
        for (Index w : ridge) std::atomic_ref(is_split[w]).store(1, std::memory_order_relaxed);
      if (link.size() >= kMinLinkSize) add(spans ? 0 : 1, ridge, e);
    }
  });
}

template <int D>
typename PathTopology<D>::Fans collect_boundary_fans(const SimplexMesh<D>& mesh) {
  constexpr std::size_t kMinLinkSize = 4;  // link vertices of three elements
  const auto collect = [&](Index b, std::vector<Index>& link, auto&& add) {
    for (int k = 0; k < D; ++k) {
      if (mesh.boundary_neighbours()[b][k] < b) continue;
      collect_boundary_link(mesh, b, k, link);
      if (link.size() < kMinLinkSize) continue;
      const auto& f = mesh.boundary_faces()[b];
      if constexpr (D == 3) {  // the link turns counter-clockwise against the face's own order
        add(0, {f[(k + 2) % 3], f[(k + 1) % 3]}, mesh.boundary_owners()[b].element());
      } else {  // and from the next vertex inward, not from the one before
        if (k == 0) std::reverse(link.begin(), link.end());
        add(0, {f[1 - k]}, mesh.boundary_owners()[b].element());
      }
    }
  };
  return collect_fans<D, 1>(mesh.boundary_face_count(), collect).all;
}

/// Tells at which boundary vertices several corners of the material meet. Which way the branches would go is never the
/// same, so that there are few of them.
template <int D>
class SplitSearch {
 public:
  explicit SplitSearch(const SimplexMesh<D>& mesh)
      : mesh_(mesh), reached_at_(mesh.element_count(), kNone), faces_at_(D == 3 ? mesh.vertex_count() : 0) {}

  bool operator()(Index v) { return is_torn(v) || has_crowded_edge(v); }

 private:
  /// Whether the elements of a vertex do not all reach each other across faces at the vertex.
  bool is_torn(Index v) {
    const auto star = mesh_.vertex_elements(v);
    if (star.size() < 2) return false;
    reached_.resize(star.size() + 1);  // and a place for what is not new
    reached_[0] = star.front();
    reached_at_[star.front()] = v;
    std::size_t count = 1;
    for (std::size_t i = 0; i < count; ++i) {
      const Index element = reached_[i];
      const auto& vertices = mesh_.elements()[element];
      const auto& neighbours = mesh_.neighbours()[element];
      for (int k = 0; k <= D; ++k) {
        const bool leads = static_cast<int>(neighbours[k].exists()) & static_cast<int>(vertices[k] != v);
        const Index next = leads ? neighbours[k].element() : element;
        reached_[count] = next;
        count += reached_at_[next] != v;
        reached_at_[next] = v;
      }
    }
    return count != star.size();
  }

  /// Whether an edge of the vertex has more boundary faces than two.
  bool has_crowded_edge(Index v) {
    bool is_crowded = false;
    if constexpr (D == 3) {
      for (const Index face : mesh_.vertex_boundary_faces(v))
        for (const Index w : mesh_.boundary_faces()[face]) {
          Faces& faces = faces_at_[w];
          const int count = faces.at == v ? faces.count + 1 : 1;
          is_crowded |= count > 2 && w != v;
          faces = {v, count};
        }
    }
    return is_crowded;
  }

  struct Faces {
    Index at = kNone;  ///< the vertex at which they were counted last
    int count = 0;
  };

  const SimplexMesh<D>& mesh_;
  std::vector<Index> reached_at_;  ///< per element the vertex at which it was reached last
  std::vector<Index> reached_;
  std::vector<Faces> faces_at_;  ///< per vertex the boundary faces on an edge to it
};

template <int D>
std::vector<std::uint8_t> find_split_vertices(const SimplexMesh<D>& mesh) {
  std::vector<std::uint8_t> is_split(mesh.vertex_count(), 0);
  const std::span<const Index> vertices = mesh.boundary_vertices();
  // Each piece clears a mark per element: few pieces.
  const std::int64_t at_once = std::max<std::int64_t>(1024, mesh.element_count() / 64);
  parallel_ranges(std::ssize(vertices), at_once, [&](std::int64_t first, std::int64_t last) {
    SplitSearch<D> splits(mesh);
    for (const Index v : vertices.subspan(first, last - first)) is_split[v] = splits(v);
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
std::vector<HalfFace> find_disagreeing(const SimplexMesh<D>& mesh) {
  std::vector<HalfFace> found;
  std::mutex listing;
  parallel_for(mesh.element_count(), kGrain, [&](std::int64_t e) {
    for (int i = 0; i <= D; ++i) {
      const HalfFace across = mesh.neighbours()[e][i];
      if (!across.exists() || across.element() < e ||
          is_odd(mesh.face_of(mesh.elements()[e], i), mesh.face_of(mesh.elements()[across.element()], across.face())))
        continue;
      const std::lock_guard lock(listing);
      found.push_back(HalfFace::of(static_cast<Index>(e), i));
    }
  });
  std::sort(found.begin(), found.end(), [](HalfFace a, HalfFace b) { return a.code < b.code; });
  return found;
}

template <int D>
std::vector<PathElement<D>> list_elements(const SimplexMesh<D>& mesh) {
  std::vector<PathElement<D>> elements(mesh.element_count());
  parallel_for(std::ssize(elements), kGrain, [&](std::int64_t e) {
    elements[e].vertices = mesh.elements()[e];
    for (int i = 0; i <= D; ++i) elements[e].neighbours[i] = mesh.neighbours()[e][i].code;
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
      component_count(component_of.empty() ? 0 : *std::max_element(component_of.begin(), component_of.end()) + 1),
      hints(nearest_boundary_faces(mesh)),
      elements(list_elements(mesh)),
      face_stars(list_face_stars(mesh, component_of)),
      is_split(find_split_vertices(mesh)),
      is_on_boundary(find_boundary(mesh)),
      disagreeing(find_disagreeing(mesh)),
      boundary_fans(collect_boundary_fans(mesh)),
      rims(mesh) {
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    inner_vertex_count += is_on_boundary[v] == 0 && !mesh.vertex_elements(v).empty();
  SortedFans<D, 2> sorted = collect_interior_fans<D>(mesh, is_on_boundary, is_split);
  interior_fans = std::move(sorted.all);
  spanning_count = sorted.ends[0];
  for (Fans* fans : {&interior_fans, &boundary_fans}) fans->fans.push_back({{}, kNone, std::ssize(fans->links)});
}

template struct PathTopology<2>;
template struct PathTopology<3>;

}  // namespace selvage
