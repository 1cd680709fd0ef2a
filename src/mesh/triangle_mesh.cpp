#include "selvage/mesh/triangle_mesh.h"

#include "mesh/tuple_check.h"
#include "mesh/vertex_stars.h"
#include "selvage/core/parallel.h"

#include <numeric>

namespace selvage {

namespace {

constexpr std::int64_t kVerticesAtOnce = 2048;

/// One triangle's side of an edge, seen from the edge's smaller vertex.
struct Spoke {
  Index other;  ///< the edge's larger vertex
  Index triangle;
  int opposite;  ///< number of the triangle's vertex that is not on the edge

  friend auto operator<=>(const Spoke&, const Spoke&) = default;
};

/// Spokes of all edges whose smaller vertex is v, edge by edge and ascending by triangle within an edge.
void gather_spokes(Index v, std::span<const TriangleMesh::Triangle> triangles, std::span<const Index> star,
                   std::vector<Spoke>& spokes) {
  spokes.clear();
  for (Index t : star) {
    for (int i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax(triangles[t][(i + 1) % 3], triangles[t][(i + 2) % 3]);
      if (low == v) spokes.push_back({high, t, i});
    }
  }
  std::sort(spokes.begin(), spokes.end());
}

std::int64_t count_edges(std::span<const Spoke> spokes) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) count += i == 0 || spokes[i].other != spokes[i - 1].other;
  return count;
}

/// Calls visit(v, spokes) for every vertex, in parallel.
template <typename Visit>
void for_each_vertex(const TriangleMesh& mesh, Visit&& visit) {
  parallel_ranges(mesh.vertex_count(), kVerticesAtOnce, [&](std::int64_t first, std::int64_t last) {
    std::vector<Spoke> spokes;
    for (Index v = static_cast<Index>(first); v < last; ++v) {
      gather_spokes(v, mesh.triangles(), mesh.vertex_triangles(v), spokes);
      visit(v, std::span<const Spoke>(spokes));
    }
  });
}

}  // namespace

TriangleMesh::TriangleMesh(Index vertex_count, std::vector<Triangle> triangles)
    : vertex_count_(vertex_count), triangles_(std::move(triangles)) {
  check_tuples<3>(vertex_count_, triangles_, "triangle");
  build_vertex_stars<3>(vertex_count_, triangles_, vertex_triangle_, vertex_triangle_first_);

  // Edges are numbered by their smaller vertex, so that each vertex lists its own once all know how many came before.
  std::vector<Index> first_edge(static_cast<std::size_t>(vertex_count_) + 1, 0), first_spoke = first_edge;
  for_each_vertex(*this, [&](Index v, std::span<const Spoke> spokes) {
    first_edge[v + 1] = static_cast<Index>(count_edges(spokes));
    first_spoke[v + 1] = static_cast<Index>(spokes.size());
  });
  std::inclusive_scan(first_edge.begin(), first_edge.end(), first_edge.begin());
  std::inclusive_scan(first_spoke.begin(), first_spoke.end(), first_spoke.begin());

  edges_.resize(first_edge.back());
  edge_triangle_first_.resize(edges_.size() + 1);
  edge_triangle_first_.back() = first_spoke.back();
  edge_triangle_.resize(first_spoke.back());
  triangle_edges_.resize(triangles_.size());
  for_each_vertex(*this, [&](Index v, std::span<const Spoke> spokes) {
    Index edge = first_edge[v] - 1, place = first_spoke[v], other = kNone;
    for (const Spoke& spoke : spokes) {
      if (spoke.other != other) {
        other = spoke.other;
        edges_[++edge] = {v, other};
        edge_triangle_first_[edge] = place;
      }
      edge_triangle_[place++] = spoke.triangle;
      triangle_edges_[spoke.triangle][spoke.opposite] = edge;
    }
  });
}

}  // namespace selvage
