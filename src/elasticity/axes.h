#pragma once

#include <Eigen/Core>

namespace selvage {

/// F = U diag(stretches) V^T with rotations U and V; the last stretch is the least, and negative where F is inverted.
/// By Jacobi's rotations of the columns of F (Hestenes 1958): a few sweeps over three pairs. Where F is not finite, or
/// its square is not, the axes are those of space and the stretches its sum.
struct StretchAxes {
  Eigen::Matrix3d u, v;
  Eigen::Vector3d stretches;

  explicit StretchAxes(const Eigen::Matrix3d& f);
};

/// A symmetric matrix = axes diag(values) axes^T, in no particular order, by Jacobi's rotations. Where it is not
/// finite the values are not either.
struct SymmetricAxes {
  Eigen::Matrix3d axes;
  Eigen::Vector3d values;

  explicit SymmetricAxes(const Eigen::Matrix3d& matrix);

  /// The nearest matrix without negative eigenvalues.
  Eigen::Matrix3d positive_part() const { return axes * values.cwiseMax(0).asDiagonal() * axes.transpose(); }
};

}  // namespace selvage
