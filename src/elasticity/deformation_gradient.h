#pragma once

#include "selvage/core/types.h"

#include <Eigen/LU>

namespace selvage {

/// Edges of an element from its first vertex, as columns.
inline Eigen::Matrix3d element_edges(const VertexTuple<4>& element, std::span<const Vec3> positions) {
  Eigen::Matrix3d edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = positions[element[k + 1]] - positions[element[0]];
  return edges;
}

/// Signed volume of an element [m^3].
inline double element_volume(const VertexTuple<4>& element, std::span<const Vec3> positions) {
  return element_edges(element, positions).determinant() / 6;
}

}  // namespace selvage
