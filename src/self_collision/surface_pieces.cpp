#include "self_collision/surface_pieces.h"

#include "selvage/core/parallel.h"

#include <atomic>
#include <numeric>

namespace selvage {

namespace {

/// Corner of a triangle as the mesh lists it that is corner k of the triangle as we do.
int listed_corner(int k, bool turned) {
  return turned ? (3 - k) % 3 : k;
}

/// Whether two triangles run along the edge between them in opposite directions, as the mesh lists them.
bool do_agree(const TriangleMesh& mesh, Index edge, std::span<const Index> triangles) {
  bool forward[2];
  for (int side = 0; side < 2; ++side) {
    const int opposite = static_cast<int>(
        std::find(mesh.triangle_edges()[triangles[side]].begin(), mesh.triangle_edges()[triangles[side]].end(), edge) -
        mesh.triangle_edges()[triangles[side]].begin());
    forward[side] = mesh.triangles()[triangles[side]][(opposite + 1) % 3] == mesh.edges()[edge][0];
  }
  return forward[0] != forward[1];
}

bool do_all_agree(const TriangleMesh& mesh) {
  std::atomic<bool> all = true;
  parallel_for(mesh.edge_count(), 8192, [&](std::int64_t e) {
    const auto triangles = mesh.edge_triangles(static_cast<Index>(e));
    if (triangles.size() == 2 && !do_agree(mesh, static_cast<Index>(e), triangles))
      all.store(false, std::memory_order_relaxed);
  });
  return all;
}

/// For each triangle whether it must be turned so that it agrees with its neighbours, each component starting from its
/// first triangle.
std::vector<char> find_turned(const TriangleMesh& mesh) {
  std::vector<char> turned(mesh.triangle_count(), 0);
  if (do_all_agree(mesh)) return turned;
  std::vector<char> seen(mesh.triangle_count(), 0);
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
  turn_triangles(mesh, order);
  link_edges(mesh, order);
  find_contours(bvh);
}

int SurfacePieces::child_at(std::span<const BvhNode> nodes, Index node, Index place) const {
  const BvhNode& parent = nodes[node];
  for (int i = 0; i < parent.child_count && parent.children[i] < 0; ++i)
    if (ranges_[~parent.children[i]].holds(place)) return i;
  return parent.child_count - (ranges_[node].last - place);
}

void SurfacePieces::turn_triangles(const TriangleMesh& mesh, std::span<const Index> order) {
  const std::vector<char> turned = find_turned(mesh);
  triangles_.resize(order.size());
  turned_.resize(order.size());
  parallel_for(std::ssize(order), 8192, [&](std::int64_t place) {
    turned_[place] = turned[order[place]];
    for (int k = 0; k < 3; ++k) triangles_[place][k] = mesh.triangles()[order[place]][listed_corner(k, turned_[place])];
  });
}

void SurfacePieces::link_edges(const TriangleMesh& mesh, std::span<const Index> order) {
  std::vector<Index> place_of(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) place_of[order[place]] = static_cast<Index>(place);
  const auto edge_at = [&](Index place, int i) {
    return mesh.triangle_edges()[order[place]][listed_corner((i + 2) % 3, turned_[place])];
  };
  opposite_.assign(3 * order.size(), kNone);
  parallel_for(std::ssize(opposite_), 8192, [&](std::int64_t directed) {
    const Index edge = static_cast<Index>(directed), place = edge / 3;
    const auto triangles = mesh.edge_triangles(edge_at(place, edge % 3));
    if (triangles.size() != 2) return;
    const Index other = place_of[triangles[triangles[0] == order[place] ? 1 : 0]];
    for (int i = 0; i < 3; ++i)
      if (tail(3 * other + i) == head(edge) && head(3 * other + i) == tail(edge)) opposite_[edge] = 3 * other + i;
  });
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
