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
  /// @param first_cloth  the first triangle of cloth
  TangledVertices(const TriangleMesh& surface, Index first_cloth, Index body_faces, bool is_strict);

  /// Takes a new pose: vertices and edges that are inside elements, and pairs of faces that meet. O(their number), and
  /// O(n) where is_strict has to judge.
  void mark(std::span<const Index> inside_vertices, std::span<const Index> inside_edges,
            std::span<const TrianglePair> crossings);

  bool has(Index vertex) const { return is_tangled_[vertex] != 0; }
  bool has_any(std::span<const Index> vertices) const;
  /// Whether both have one, and are of cloth: they are to get out by the way that they came.
  bool is_of_cloth(std::span<const Index> one, std::span<const Index> other) const {
    return is_cloth_[one[0]] != 0 && is_cloth_[other[0]] != 0 && has_any(one) && has_any(other);
  }
  /// Whether what meets of two features is left to contacts: of cloth where both have one, else where any has.
  bool leaves_out(std::span<const Index> one, std::span<const Index> other) const {
    return is_cloth_[one[0]] != 0 && is_cloth_[other[0]] != 0 ? is_of_cloth(one, other)
                                                              : has_any(one) || has_any(other);
  }
  std::span<const Index> vertices() const { return vertices_; }
  Index count() const { return static_cast<Index>(vertices_.size()); }

 private:
  void add(std::span<const Index> vertices);
  void add_enclosed_pieces(std::span<const Index> inside_vertices);

  const TriangleMesh& surface_;
  Index body_faces_;
  bool is_strict_;
  std::vector<Index> vertices_;
  std::vector<std::uint8_t> is_tangled_, is_cloth_;  ///< (n_vertices)
};

}  // namespace selvage
