#pragma once

#include "selvage/mesh/simplex_mesh.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// Vertices where bodies penetrate: what is inside, and those of faces that meet others.
class TangledVertices {
 public:
  /// @param surface      the boundary of the mesh, cloth, then triangles of colliders; must outlive this
  /// @param body_faces   triangles of the boundary and of cloth
  /// @param is_strict    whether what is inside counts only with a reason that the surface shows: some face meets
  ///                     another, or all of a connected piece of the surface is inside. Else an inverted element alone,
  ///                     in which points are by mistake, makes its neighbours count.
  TangledVertices(const TriangleMesh& surface, Index body_faces, bool is_strict);

  /// Takes a new pose: vertices and edges that are inside elements, and pairs of faces that meet. O(their number), and
  /// O(n) where is_strict has to judge.
  void mark(std::span<const Index> inside_vertices, std::span<const Index> inside_edges,
            std::span<const TrianglePair> crossings);

  bool has(Index vertex) const { return is_tangled_[vertex] != 0; }
  bool has_any(std::span<const Index> vertices) const;
  Index count() const { return static_cast<Index>(vertices_.size()); }

 private:
  void add(std::span<const Index> vertices);
  void add_enclosed_pieces(std::span<const Index> inside_vertices);

  const TriangleMesh& surface_;
  Index body_faces_;
  bool is_strict_;
  std::vector<Index> vertices_;
  std::vector<std::uint8_t> is_tangled_;  ///< (n_vertices)
};

}  // namespace selvage
