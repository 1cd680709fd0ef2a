#pragma once

#include "selvage/mesh/simplex_mesh.h"

#include <algorithm>
#include <span>

namespace selvage {

/// Vertices of inverted elements, at which the surface is no border of the body: ContactOptions::wait_for_inverted.
class InvertedVertices {
 public:
  InvertedVertices() = default;
  /// Of all elements.
  InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions);
  /// Of some elements, which need not all be inverted.
  InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Index> elements);

  bool empty() const { return vertices_.empty(); }
  std::span<const Index> vertices() const { return vertices_; }  ///< ascending

  bool has(Index vertex) const;
  bool has_any(std::span<const Index> vertices) const {
    return std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return has(v); });
  }

  /// Whether any of the vertices whose weight is not 0 is one. A point on an edge of a face does not depend on the
  /// face's third vertex.
  template <typename Weights>
  bool has_any(std::span<const Index> vertices, const Weights& weights) const {
    if (empty()) return false;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (weights[i] != 0 && has(vertices[i])) return true;
    return false;
  }

 private:
  std::vector<Index> vertices_;  ///< ascending
};

}  // namespace selvage
