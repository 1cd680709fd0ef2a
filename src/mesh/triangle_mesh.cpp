#include "selvage/mesh/triangle_mesh.h"

#include "core/parallel.h"
#include "core/union_find.h"
#include "mesh/tuple_check.h"
#include "mesh/vertex_stars.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace selvage {

namespace {

constexpr Index kVerticesPerChunk = 2048;

/// One triangle's side of an edge, seen from the edge's smaller vertex: in one number, which sorts edge by edge and
/// ascending by triangle within an edge.
class Spoke {
 public:
  /// @param other     the edge's larger vertex
  /// @param opposite  number of the triangle's vertex that is not on the edge
  /// @param outward   whether the triangle runs along the edge towards the larger vertex
  Spoke(Index other, Index triangle, int opposite, bool outward)
      : code_(static_cast<std::uint64_t>(other) << 32 | static_cast<std::uint32_t>(triangle) << 3 |
              static_cast<std::uint32_t>(opposite) << 1 | static_cast<std::uint32_t>(outward)) {}

  Index other() const { return static_cast<Index>(code_ >> 32); }
  Index triangle() const { return static_cast<Index>(static_cast<std::uint32_t>(code_) >> 3); }
  int opposite() const { return static_cast<int>(code_ >> 1 & 3); }
  bool is_outward() const { return (code_ & 1) != 0; }

  /// As in TriangleMesh::neighbours().
  HalfFace half_face() const { return HalfFace::of(triangle(), opposite()); }

  friend auto operator<=>(const Spoke&, const Spoke&) = default;

 private:
  std::uint64_t code_;  // check_tuples() leaves 29 bits to a triangle
};

/// Adds the spokes of all edges whose smaller vertex is v, sorted.
void gather_spokes(const TriangleMesh& mesh, Index v, std::vector<Spoke>& spokes) {
  const auto first = std::ssize(spokes);
  for (const Index t : mesh.vertex_triangles(v)) {
    const auto& vertices = mesh.triangles()[t];
    const int place = vertices[0] == v ? 0 : vertices[1] == v ? 1 : 2;
    const int next = place == 2 ? 0 : place + 1, last = place == 0 ? 2 : place - 1;
    if (vertices[next] > v) spokes.emplace_back(vertices[next], t, last, true);
    if (vertices[last] > v) spokes.emplace_back(vertices[last], t, next, false);
  }
  std::sort(spokes.begin() + first, spokes.end());
}

Index count_edges(std::span<const Spoke> spokes) {
  Index count = 0;
  for (std::size_t i = 0; i < spokes.size(); ++i) count += i == 0 || spokes[i].other() != spokes[i - 1].other();
  return count;
}

}  // namespace

TriangleMesh::TriangleMesh(Index vertex_count, std::vector<Triangle> triangles)
    : vertex_count_(vertex_count), triangles_(std::move(triangles)) {
  check_tuples<3>(vertex_count_, triangles_, "triangle");
  build_vertex_stars<3>(vertex_count_, triangles_, vertex_triangle_, vertex_triangle_first_);

  // Edges are numbered by their smaller vertex, so that each vertex lists its own once all know how many came before.
  const Index chunks = (vertex_count_ + kVerticesPerChunk - 1) / kVerticesPerChunk;
  const auto visit_vertices = [&](std::int64_t chunk, auto&& visit) {
    const Index first = static_cast<Index>(chunk) * kVerticesPerChunk;
    for (Index v = first; v < std::min(first + kVerticesPerChunk, vertex_count_); ++v) visit(v);
  };
  std::vector<std::vector<Spoke>> spokes(chunks);
  std::vector<Index> first_edge(static_cast<std::size_t>(vertex_count_) + 1, 0), first_spoke = first_edge;
  parallel_for(chunks, 1, [&](std::int64_t chunk) {
    const auto begin = chunk * kVerticesPerChunk;
    spokes[chunk].reserve(vertex_triangle_first_[std::min<std::int64_t>(begin + kVerticesPerChunk, vertex_count_)] -
                          vertex_triangle_first_[begin]);  // about as many: each triangle has three of both
    visit_vertices(chunk, [&](Index v) {
      const std::size_t before = spokes[chunk].size();
      gather_spokes(*this, v, spokes[chunk]);
      const std::span own = std::span<const Spoke>(spokes[chunk]).subspan(before);
      first_edge[v + 1] = count_edges(own);
      first_spoke[v + 1] = static_cast<Index>(own.size());
    });
  });
  std::inclusive_scan(first_edge.begin(), first_edge.end(), first_edge.begin());
  std::inclusive_scan(first_spoke.begin(), first_spoke.end(), first_spoke.begin());

  edges_.resize(first_edge.back());
  edge_triangle_first_.resize(edges_.size() + 1);
  edge_triangle_first_.back() = first_spoke.back();
  edge_triangle_.resize(first_spoke.back());
  triangle_edges_.resize(triangles_.size());
  neighbours_.resize(triangles_.size());
  std::atomic<bool> all_agree = true;
  parallel_for(chunks, 1, [&](std::int64_t chunk) {
    const Spoke* spoke = spokes[chunk].data();
    bool agree = true;
    visit_vertices(chunk, [&](Index v) {
      Index edge = first_edge[v];
      for (Index place = first_spoke[v]; place < first_spoke[v + 1]; ++edge) {
        edges_[edge] = {v, spoke->other()};
        edge_triangle_first_[edge] = place;
        const Spoke* const first = spoke;
        do {
          edge_triangle_[place] = spoke->triangle();
          triangle_edges_[spoke->triangle()][spoke->opposite()] = edge;
          neighbours_[spoke->triangle()][spoke->opposite()] = {};
          ++spoke;
        } while (++place < first_spoke[v + 1] && spoke->other() == first->other());
        if (spoke - first != 2) continue;
        neighbours_[first[0].triangle()][first[0].opposite()] = first[1].half_face();
        neighbours_[first[1].triangle()][first[1].opposite()] = first[0].half_face();
        agree = agree && first[0].is_outward() != first[1].is_outward();
      }
    });
    if (!agree) all_agree.store(false, std::memory_order_relaxed);
  });
  is_oriented_ = all_agree;
}

std::vector<Index> connected_pieces(const TriangleMesh& mesh) {
  UnionFind pieces(mesh.triangles().size());
  for (Index t = 0; t < mesh.triangle_count(); ++t)
    for (const Index v : mesh.triangles()[t]) pieces.join(mesh.vertex_triangles(v).front(), t);
  return pieces.numbered();
}

TriangleMesh boundary_surface(const TetMesh& mesh) {
  return {mesh.vertex_count(), {mesh.boundary_faces().begin(), mesh.boundary_faces().end()}};
}

IndexedMesh boundary_mesh(const TetMesh& mesh, std::span<const Vec3> positions) {
  if (std::ssize(positions) != mesh.vertex_count())
    throw Error("positions", fmt::format("{} for {} vertices", positions.size(), mesh.vertex_count()),
                "give one per vertex");
  IndexedMesh surface;
  std::vector<Index> number(positions.size(), kNone);
  for (const Index v : mesh.boundary_vertices()) {
    number[v] = static_cast<Index>(surface.positions.size());
    surface.positions.push_back(positions[v]);
  }
  for (const auto& [a, b, c] : mesh.boundary_faces()) surface.triangles.push_back({number[a], number[b], number[c]});
  return surface;
}

}  // namespace selvage
