#pragma once

#include "bvh/bvh.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// Some vertices of a surface, and the triangles that have one of them.
class MarkedVertices {
 public:
  /// @param mesh  must outlive this
  explicit MarkedVertices(const TriangleMesh& mesh);

  /// Marks a vertex, unless it is marked.
  void mark(Index vertex);
  /// Forgets all. O(their number).
  void clear();

  std::span<const Index> vertices() const { return vertices_; }
  std::span<const Index> triangles() const { return triangles_; }
  bool has(Index vertex) const { return is_marked_[vertex] != 0; }
  bool has_any(std::span<const Index> vertices) const;

  /// (n_vertices), (n_triangles) not 0: marked.
  std::span<const std::uint8_t> vertex_marks() const { return is_marked_; }
  std::span<const std::uint8_t> triangle_marks() const { return is_triangle_marked_; }
  /// (n_nodes) bit i: there are such triangles below child i, or it is one. O(n_nodes).
  std::span<const std::uint8_t> node_marks(std::span<const BvhNode> nodes);

 private:
  const TriangleMesh& mesh_;
  std::vector<Index> vertices_, triangles_;
  std::vector<std::uint8_t> is_marked_, is_triangle_marked_, node_marks_;
};

}  // namespace selvage
