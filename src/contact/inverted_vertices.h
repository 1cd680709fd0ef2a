#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Vertices of inverted elements. The surface at them lies where it should not: ContactOptions::wait_for_inverted.
class InvertedVertices {
 public:
  InvertedVertices() = default;
  /// Of all elements.
  InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions);
  /// Of some elements, which need not all be inverted.
  InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Index> elements);

  bool empty() const { return vertices_.empty(); }

  /// Whether any of some vertices that have a weight is one: a point of an edge has nothing to do with the third vertex
  /// of a face.
  template <typename Weights>
  bool has_any(std::span<const Index> vertices, const Weights& weights) const {
    if (empty()) return false;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (weights[i] != 0 && has(vertices[i])) return true;
    return false;
  }

 private:
  bool has(Index vertex) const;

  std::vector<Index> vertices_;  ///< ascending
};

}  // namespace selvage
