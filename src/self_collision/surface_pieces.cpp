#include "self_collision/surface_pieces.h"

#include "self_collision/contour_kernel.h"
#include "selvage/core/parallel.h"

#include <atomic>
#include <cstring>

namespace selvage {

namespace {

/// Number of the triangle's corner opposite an edge, as the mesh lists its corners.
int opposite_corner(const TriangleMesh& mesh, Index triangle, Index edge) {
  const auto& edges = mesh.triangle_edges()[triangle];
  return edges[0] == edge ? 0 : edges[1] == edge ? 1 : 2;
}

/// Whether two triangles run along the edge between them in opposite directions, as the mesh lists them.
bool do_agree(const TriangleMesh& mesh, Index edge, std::span<const Index> triangles) {
  bool forward[2];
  for (int side = 0; side < 2; ++side) {
    const int opposite = opposite_corner(mesh, triangles[side], edge);
    forward[side] = mesh.triangles()[triangles[side]][(opposite + 1) % 3] == mesh.edges()[edge][0];
  }
  return forward[0] != forward[1];
}

/// For each triangle whether it must be turned so that it agrees with its neighbours, each component starting from its
/// first triangle.
std::vector<char> find_turned(const TriangleMesh& mesh) {
  std::vector<char> turned(mesh.triangle_count(), 0), seen = turned;
  std::vector<Index> waiting;
  for (Index start = 0; start < mesh.triangle_count(); ++start) {
    if (seen[start]) continue;
    seen[start] = 1;
    waiting.push_back(start);
    while (!waiting.empty()) {
      const Index t = waiting.back();
      waiting.pop_back();
      for (const Index edge : mesh.triangle_edges()[t]) {
        const auto triangles = mesh.edge_triangles(edge);
        if (triangles.size() != 2) continue;
        const Index other = triangles[triangles[0] == t ? 1 : 0];
        if (seen[other]) continue;
        seen[other] = 1;
        turned[other] = do_agree(mesh, edge, triangles) ? turned[t] : !turned[t];
        waiting.push_back(other);
      }
    }
  }
  return turned;
}

/// Places of the triangles below each node: children come after their parents, so that sizes are summed from the back
/// and places handed out from the front.
std::vector<SurfacePieces::Range> find_ranges(std::span<const BvhNode> nodes) {
  std::vector<Index> sizes(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    sizes[n] = 0;
    for (int i = 0; i < nodes[n].child_count; ++i)
      sizes[n] += nodes[n].children[i] < 0 ? sizes[~nodes[n].children[i]] : 1;
  }
  std::vector<SurfacePieces::Range> ranges(nodes.size());
  ranges[0] = {0, sizes[0]};
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    Index first = ranges[n].first;
    for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
      const Index child = ~nodes[n].children[i];
      ranges[child] = {first, first + sizes[child]};
      first += sizes[child];
    }
  }
  return ranges;
}

}  // namespace

SurfacePieces::SurfacePieces(const TriangleMesh& mesh, const Bvh& bvh) {
  if (bvh.nodes().empty()) return;
  const std::vector<Index> order = bvh.leaf_order();
  ranges_ = find_ranges(bvh.nodes());
  contours_.resize(bvh.nodes().size());
  place_triangles(mesh, order, {});
  if (!link_edges(mesh, order, {})) {
    const std::vector<char> turned = find_turned(mesh);
    place_triangles(mesh, order, turned);
    link_edges(mesh, order, turned);
  }
}

int SurfacePieces::child_at(std::span<const BvhNode> nodes, Index node, Index place) const {
  const BvhNode& parent = nodes[node];
  for (int i = 0; i < parent.child_count && parent.children[i] < 0; ++i)
    if (ranges_[~parent.children[i]].holds(place)) return i;
  return parent.child_count - (ranges_[node].last - place);
}

void SurfacePieces::place_triangles(const TriangleMesh& mesh, std::span<const Index> order,
                                    std::span<const char> turned) {
  triangles_.resize(order.size());
  parallel_for(std::ssize(order), kGrain, [&](std::int64_t place) {
    auto [a, b, c] = mesh.triangles()[order[place]];
    if (!turned.empty() && turned[order[place]]) std::swap(b, c);
    triangles_[place] = {a, b, c};
  });
}

bool SurfacePieces::link_edges(const TriangleMesh& mesh, std::span<const Index> order, std::span<const char> turned) {
  std::vector<Index> place_of(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) place_of[order[place]] = static_cast<Index>(place);
  opposite_.assign(3 * order.size(), kNone);
  std::atomic<bool> all_agree = true;
  parallel_for(mesh.edge_count(), kGrain, [&](std::int64_t edge) {
    const auto triangles = mesh.edge_triangles(static_cast<Index>(edge));
    if (triangles.size() != 2) return;
    Index directed[2];
    for (int side = 0; side < 2; ++side) {
      const int listed = opposite_corner(mesh, triangles[side], static_cast<Index>(edge));
      const int corner = !turned.empty() && turned[triangles[side]] ? (3 - listed) % 3 : listed;
      directed[side] = 3 * place_of[triangles[side]] + (corner + 1) % 3;
    }
    if (tail(directed[0]) != head(directed[1])) return all_agree.store(false, std::memory_order_relaxed);
    opposite_[directed[0]] = directed[1];
    opposite_[directed[1]] = directed[0];
  });
  return all_agree;
}

const SurfacePieces::Contours& SurfacePieces::contours(Index node, std::vector<char>& workspace) {
  if (!contours_[node]) contours_[node] = std::make_unique<const Contours>(trace_contours(node, workspace));
  return *contours_[node];
}

SurfacePieces::Contours SurfacePieces::trace_contours(Index node, std::vector<char>& workspace) const {
  Contours contours;
  const Index base = 3 * ranges_[node].first, end = 3 * ranges_[node].last;
  workspace.resize(end - base);
  char* const waiting = workspace.data();  // edges of contours that are still to come
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
