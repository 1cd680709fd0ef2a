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

/// Change of the deformation gradient by one vertex: where vertex k moves by x, F changes by x b^T, with b returned.
///
/// @param inverse_edges  inverse of the rest edges: F is the present edges times it
inline Vec3 vertex_gradient(const Eigen::Matrix3d& inverse_edges, std::ptrdiff_t k) {
  return k > 0 ? Vec3(inverse_edges.row(k - 1).transpose()) : Vec3(-inverse_edges.colwise().sum().transpose());
}

/// The matrix that takes x to a cross x.
inline Eigen::Matrix3d cross_product_matrix(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Cofactors of a deformation gradient: the derivative of its determinant.
inline Eigen::Matrix3d cofactors_of(const Eigen::Matrix3d& f) {
  Eigen::Matrix3d cofactors;
  cofactors << f.col(1).cross(f.col(2)), f.col(2).cross(f.col(0)), f.col(0).cross(f.col(1));
  return cofactors;
}

}  // namespace selvage
