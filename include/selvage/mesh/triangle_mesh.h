#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/indexed_mesh.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Topology of a triangle surface in space: open, closed, several components or non-manifold, all are legal.
///
/// Edges are listed once each, in lexicographic order of their (ascending) vertices.
/// Thread-safe: all members are const after construction.
class TriangleMesh {
 public:
  using Triangle = VertexTuple<3>;
  using Edge = VertexTuple<2>;

  TriangleMesh() = default;

  /// O(n log n), parallel.
  /// @throws Error  when there is no triangle, an index is out of range, or a triangle repeats a vertex
  TriangleMesh(Index vertex_count, std::vector<Triangle> triangles);

  Index vertex_count() const { return vertex_count_; }
  Index triangle_count() const { return static_cast<Index>(triangles_.size()); }
  Index edge_count() const { return static_cast<Index>(edges_.size()); }

  /// (n_triangles) vertices of each triangle, as they were given.
  std::span<const Triangle> triangles() const { return triangles_; }

  /// (n_edges) vertices of each edge, ascending.
  std::span<const Edge> edges() const { return edges_; }

  /// (n_triangles x 3) edge opposite to vertex i of each triangle.
  std::span<const std::array<Index, 3>> triangle_edges() const { return triangle_edges_; }

  /// (n_triangles x 3) what lies across the edge opposite to vertex i of each triangle: the other triangle, as element,
  /// and the number of its vertex opposite to that edge, as face. None exists where the edge does not have two
  /// triangles.
  std::span<const std::array<HalfFace, 3>> neighbours() const { return neighbours_; }

  /// Whether neighbours agree on which side of the surface is which: run along the edge between them in opposite
  /// directions.
  bool is_oriented() const { return is_oriented_; }

  /// Triangles on edge e, ascending: 1 on a border, 2 inside a manifold surface, more where it is non-manifold.
  std::span<const Index> edge_triangles(Index e) const { return star(edge_triangle_, edge_triangle_first_, e); }

  /// Triangles that have vertex v, ascending.
  std::span<const Index> vertex_triangles(Index v) const { return star(vertex_triangle_, vertex_triangle_first_, v); }

 private:
  static std::span<const Index> star(const std::vector<Index>& items, const std::vector<Index>& first, Index i) {
    return {items.data() + first[static_cast<std::size_t>(i)], items.data() + first[static_cast<std::size_t>(i) + 1]};
  }

  Index vertex_count_ = 0;
  std::vector<Triangle> triangles_;
  std::vector<Edge> edges_;
  std::vector<std::array<Index, 3>> triangle_edges_;
  std::vector<std::array<HalfFace, 3>> neighbours_;
  bool is_oriented_ = true;
  std::vector<Index> edge_triangle_, edge_triangle_first_;
  std::vector<Index> vertex_triangle_, vertex_triangle_first_;
};

/// Connected piece of each triangle, numbered from 0 in order of their first triangles: two triangles with a common
/// vertex are of one piece. O(n).
std::vector<Index> connected_pieces(const TriangleMesh& mesh);

/// Surface of a tetrahedral mesh: its boundary faces, outward, in the order of TetMesh::boundary_faces(), so that
/// triangle b is boundary face b. Vertices keep their numbers; those inside belong to no triangle.
///
/// The surface of a non-empty mesh is never empty and has no border, but may be non-manifold. O(n log n), parallel.
/// @throws Error  when the mesh was made by default, without an element
///
/// Example, built and run by the tests:
/// @include boundary_surface.cpp
TriangleMesh boundary_surface(const TetMesh& mesh);

/// The same as a mesh of its own, without the vertices inside: those of the boundary follow in their order.
/// @param positions  (n_vertices x 3) [m]
/// @throws Error     when sizes differ
IndexedMesh boundary_mesh(const TetMesh& mesh, std::span<const Vec3> positions);

}  // namespace selvage
