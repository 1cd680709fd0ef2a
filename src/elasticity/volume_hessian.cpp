#include "elasticity/volume_hessian.h"

#include "elasticity/axes.h"
#include "elasticity/deformation_gradient.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace selvage {

// The second derivative of J turns a change of one column into that of the cofactors of the two others.
DeformationHessian<3> volume_hessian(const Eigen::Matrix3d& f, double shear, double slope, double curvature) {
  const Eigen::Matrix3d cofactors = cofactors_of(f);
  const Eigen::Matrix<double, 9, 1> g = cofactors.reshaped();
  DeformationHessian<3> h = shear * DeformationHessian<3>::Identity() + curvature * g * g.transpose();
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    const Eigen::Matrix3d across = slope * cross_product_matrix(f.col(c));
    h.block<3, 3>(3 * a, 3 * b) -= across;
    h.block<3, 3>(3 * b, 3 * a) += across;
  }
  return h;
}

// What is negative is taken from the exact one: mostly that is a mode or two.
DeformationHessian<3> positive_volume_hessian(const Eigen::Matrix3d& f, double shear, double slope, double curvature) {
  const StretchAxes axes(f);
  const Eigen::Vector3d& s = axes.stretches;
  DeformationHessian<3> h = volume_hessian(f, shear, slope, curvature);
  const auto take_off = [&](double eigenvalue, const Eigen::Matrix3d& mode) {
    if (!(eigenvalue < 0)) return;
    const Eigen::Matrix<double, 9, 1> d = mode.reshaped();
    h.noalias() -= (eigenvalue * d) * d.transpose();
  };
  Eigen::Matrix3d scaling;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const double twist = shear + slope * s[k], flip = shear - slope * s[k];
    if (twist < 0 || flip < 0) {
      const Eigen::Matrix3d ij = std::sqrt(0.5) * axes.u.col(i) * axes.v.col(j).transpose(),
                            ji = std::sqrt(0.5) * axes.u.col(j) * axes.v.col(i).transpose();
      take_off(twist, ij - ji);
      take_off(flip, ij + ji);
    }
    scaling(k, k) = shear + curvature * (s[i] * s[j]) * (s[i] * s[j]);
    scaling(i, j) = scaling(j, i) = slope * s[k] + curvature * (s[j] * s[k]) * (s[i] * s[k]);
  }
  if (scaling.llt().info() == Eigen::Success) return h;
  const SymmetricAxes scalings(scaling);
  for (int n = 0; n < 3; ++n)
    take_off(scalings.values[n], axes.u * scalings.axes.col(n).asDiagonal() * axes.v.transpose());
  return h;
}

}  // namespace selvage
