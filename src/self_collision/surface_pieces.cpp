#include "self_collision/surface_pieces.h"

#include "selvage/core/parallel.h"

#include <atomic>
#include <numeric>

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

/// All its children are triangles.
bool is_leaf_node(const BvhNode& node) {
  return node.children[0] >= 0;
}

/// The contours of one piece.
struct Loops {
  std::vector<Index> edges;
  std::vector<Index> ends;
};

/// Lists of all nodes one after the other.
template <typename Member>
std::vector<Index> concatenate(const std::vector<Loops>& all, Member member, std::vector<std::int64_t>& first) {
  first.assign(all.size() + 1, 0);
  for (std::size_t n = 0; n < all.size(); ++n) first[n + 1] = first[n] + std::ssize(all[n].*member);
  std::vector<Index> joined(first.back());
  parallel_for(std::ssize(all), 512, [&](std::int64_t n) {
    std::copy((all[n].*member).begin(), (all[n].*member).end(), joined.begin() + first[n]);
  });
  return joined;
}

}  // namespace

SurfacePieces::SurfacePieces(const TriangleMesh& mesh, const Bvh& bvh) {
  if (bvh.nodes().empty()) return;
  const std::vector<Index> order = bvh.leaf_order();
  ranges_ = find_ranges(bvh.nodes());
  place_triangles(mesh, order, {});
  if (!link_edges(mesh, order, {})) {
    const std::vector<char> turned = find_turned(mesh);
    place_triangles(mesh, order, turned);
    link_edges(mesh, order, turned);
  }
  find_contours(bvh);
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

Index SurfacePieces::next_on_contour(Index edge, const Range& range) const {
  Index next = next_in_triangle(edge);
  while (!is_on_contour(next, range)) next = next_in_triangle(opposite_[next]);
  return next;
}

void SurfacePieces::find_contours(const Bvh& bvh) {
  const auto nodes = bvh.nodes();
  const auto levels = bvh.levels();
  std::vector<Loops> all(nodes.size());
  std::vector<char> waiting(opposite_.size(), 0);  // nodes of one level share no edge
  const auto find_loops = [&](Index n) {
    const BvhNode& node = nodes[n];
    if (is_leaf_node(node)) return;
    const Range range = ranges_[n];
    std::vector<Index> on_contour;
    const auto take = [&](Index edge) {
      if (!is_on_contour(edge, range)) return;
      on_contour.push_back(edge);
      waiting[edge] = 1;
    };
    for (int i = 0; i < node.child_count; ++i) {
      const Index child = node.children[i];
      if (child < 0 && !is_leaf_node(nodes[~child])) {
        for (const Index edge : all[~child].edges) take(edge);
        continue;
      }
      const Index place = range.last - node.child_count + i;
      const Range below = child < 0 ? ranges_[~child] : Range{place, place + 1};
      for (Index edge = 3 * below.first; edge < 3 * below.last; ++edge) take(edge);
    }
    for (const Index start : on_contour) {
      if (!waiting[start]) continue;
      for (Index edge = start; waiting[edge]; edge = next_on_contour(edge, range)) {
        waiting[edge] = 0;
        all[n].edges.push_back(edge);
      }
      all[n].ends.push_back(static_cast<Index>(all[n].edges.size()));
    }
  };
  for (std::size_t level = levels.size() - 1; level-- > 0;)
    parallel_for(levels[level + 1] - levels[level], 64,
                 [&](std::int64_t i) { find_loops(levels[level] + static_cast<Index>(i)); });
  edges_ = concatenate(all, &Loops::edges, first_edge_);
  loops_ = concatenate(all, &Loops::ends, first_loop_);
}

}  // namespace selvage
