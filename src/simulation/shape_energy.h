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

/// The energy of Material, Neo-Hookean, for a Young's modulus of 1 Pa; 0 at rest [J].
inline double element_energy(const VertexTuple<4>& element, std::span<const Vec3> rest, std::span<const Vec3> positions,
                             double poisson_ratio) {
  const Eigen::Matrix3d rest_edges = element_edges(element, rest);
  const Eigen::Matrix3d gradient = element_edges(element, positions) * rest_edges.inverse();
  const double mu = 1 / (2 * (1 + poisson_ratio));
  const double lambda = 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio);
  const double growth = gradient.determinant() - 1;
  // Written out from rest, where the terms that cancel are large.
  const double density = mu / 2 * (gradient.squaredNorm() - 3) - mu * growth + (lambda + mu) / 2 * growth * growth;
  return density * rest_edges.determinant() / 6;
}

}  // namespace selvage
