#include "self_collision/culling/surface_pieces.h"

#include "core/parallel.h"
#include "core/simd/simd.h"
#include "self_collision/culling/contour_kernel.h"

#include <cstring>

namespace selvage {

namespace {

/// Whether two triangles run along the edge between them in opposite directions, as the mesh lists them.
///
/// @param corner  the number of the triangle's vertex opposite to that edge
/// @param across  what lies across it (see TriangleMesh::neighbours())
bool do_agree(const TriangleMesh& mesh, Index triangle, int corner, HalfFace across) {
  return mesh.triangles()[triangle][(corner + 1) % 3] == mesh.triangles()[across.element()][(across.face() + 2) % 3];
}

/// For each triangle whether it must be turned so that it agrees with its neighbours, each component starting from its
/// first triangle.
std::vector<char> find_reversed_triangles(const TriangleMesh& mesh) {
  std::vector<char> turned(mesh.triangle_count(), 0), seen = turned;
  std::vector<Index> waiting;
  for (Index start = 0; start < mesh.triangle_count(); ++start) {
    if (seen[start]) continue;
    seen[start] = 1;
    waiting.push_back(start);
    while (!waiting.empty()) {
      const Index t = waiting.back();
      waiting.pop_back();
      for (int i = 0; i < 3; ++i) {
        const HalfFace across = mesh.neighbours()[t][i];
        if (!across.exists() || seen[across.element()]) continue;
        seen[across.element()] = 1;
        turned[across.element()] = do_agree(mesh, t, i, across) ? turned[t] : !turned[t];
        waiting.push_back(across.element());
      }
    }
  }
  return turned;
}

/// Places of the triangles below each node: children come after their parents, so that sizes are summed from the back
/// and places handed out from the front.
UnsetVector<SurfacePieces::Range> find_ranges(std::span<const BvhNode> nodes) {
  UnsetVector<SurfacePieces::Range> ranges(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    Index size = 0;
    for (int i = 0; i < nodes[n].child_count; ++i)
      size += nodes[n].children[i] < 0 ? ranges[~nodes[n].children[i]].last : 1;
    ranges[n] = {0, size};
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    Index first = ranges[n].first;
    for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
      const Index child = ~nodes[n].children[i];
      ranges[child] = {first, first + ranges[child].last};
      first = ranges[child].last;
    }
  }
  return ranges;
}

}  // namespace

SurfacePieces::SurfacePieces(const TriangleMesh& mesh, const Bvh& bvh) {
  if (bvh.nodes().empty()) return;
  ranges_ = find_ranges(bvh.nodes());
  contours_.resize(bvh.nodes().size());
  const std::vector<char> turned = mesh.is_oriented() ? std::vector<char>() : find_reversed_triangles(mesh);
  link_edges(turned, place_triangles(mesh, bvh.nodes(), turned));
}

int SurfacePieces::child_at(std::span<const BvhNode> nodes, Index node, Index place) const {
  const BvhNode& parent = nodes[node];
  for (int i = 0; i < parent.child_count && parent.children[i] < 0; ++i)
    if (ranges_[~parent.children[i]].holds(place)) return i;
  return parent.child_count - (ranges_[node].last - place);
}

UnsetVector<Index> SurfacePieces::place_triangles(const TriangleMesh& mesh, std::span<const BvhNode> nodes,
                                                  std::span<const char> turned) {
  UnsetVector<Index> order(mesh.triangle_count()), place_of(mesh.triangle_count());
  triangles_.resize(mesh.triangle_count());
  opposite_.resize(3 * triangles_.size());
  parallel_for(std::ssize(nodes), kGrain, [&](std::int64_t n) {
    Index place = ranges_[n].last;  // those of a node come after all that are further down
    for (int i = nodes[n].child_count; i-- > 0 && nodes[n].children[i] >= 0;) order[--place] = nodes[n].children[i];
  });
  parallel_for(mesh.triangle_count(), kGrain, [&](std::int64_t place) {
    constexpr std::int64_t kAhead = 24;
    if (place + kAhead < std::ssize(order)) {
      prefetch(&mesh.triangles()[order[place + kAhead]]);
      prefetch(&mesh.neighbours()[order[place + kAhead]]);
    }
    const Index t = order[place];
    place_of[t] = static_cast<Index>(place);
    auto [a, b, c] = mesh.triangles()[t];
    auto [across_a, across_b, across_c] = mesh.neighbours()[t];
    if (!turned.empty() && turned[t]) {
      std::swap(b, c);
      std::swap(across_b, across_c);
    }
    triangles_[place] = {a, b, c};
    opposite_[3 * place] = across_c.code;
    opposite_[3 * place + 1] = across_a.code;
    opposite_[3 * place + 2] = across_b.code;
  });
  return place_of;
}

void SurfacePieces::link_edges(std::span<const char> turned, std::span<const Index> place_of) {
  parallel_for(std::ssize(opposite_), 3 * kGrain, [&](std::int64_t edge) {
    const HalfFace across{opposite_[edge]};
    if (!across.exists()) return;
    const int corner = !turned.empty() && turned[across.element()] ? (3 - across.face()) % 3 : across.face();
    const Index other = 3 * place_of[across.element()] + (corner == 2 ? 0 : corner + 1);
    opposite_[edge] = turned.empty() || tail(static_cast<Index>(edge)) == head(other) ? other : kNone;
  });
}

const SurfacePieces::Contours& SurfacePieces::contours(Index node, std::vector<char>& workspace) {
  if (!contours_[node]) contours_[node] = std::make_unique<const Contours>(trace_contours(node, workspace));
  return *contours_[node];
}

SurfacePieces::Contours SurfacePieces::trace_contours(Index node, std::vector<char>& workspace) const {
  Contours contours;
  const Index base = 3 * ranges_[node].first, end = 3 * ranges_[node].last;
  workspace.resize(end - base);
  char* const waiting = workspace.data();  // edges of contours not yet traced
  SELVAGE_DISPATCH(mark_contour, opposite_.data(), base, end, waiting);
  const auto next_on_contour = [&](Index edge) {
    Index next = next_in_triangle(edge);
    while (opposite_[next] >= base && opposite_[next] < end) next = next_in_triangle(opposite_[next]);
    return next;
  };
  for (Index start = base;; ++start) {
    const void* const found = std::memchr(waiting + (start - base), 1, static_cast<std::size_t>(end - start));
    if (found == nullptr) return contours;
    start = base + static_cast<Index>(static_cast<const char*>(found) - waiting);
    for (Index edge = start; waiting[edge - base] != 0; edge = next_on_contour(edge)) {
      waiting[edge - base] = 0;
      contours.edges.push_back(edge);
    }
    contours.loops.push_back(static_cast<Index>(contours.edges.size()));
  }
}

}  // namespace selvage
