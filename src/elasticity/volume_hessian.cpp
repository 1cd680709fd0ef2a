#include "elasticity/volume_hessian.h"

#include "elasticity/deformation_gradient.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <cmath>

namespace selvage {

StretchAxes::StretchAxes(const Eigen::Matrix3d& f) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (svd.info() != Eigen::Success) {  // F is not finite
    u = v = Eigen::Matrix3d::Identity();
    stretches.setConstant(f.sum());
    return;
  }
  u = svd.matrixU();
  v = svd.matrixV();
  stretches = svd.singularValues();
  if (u.determinant() < 0) {
    u.col(2) = -u.col(2);
    stretches[2] = -stretches[2];
  }
  if (v.determinant() < 0) {
    v.col(2) = -v.col(2);
    stretches[2] = -stretches[2];
  }
}

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

DeformationHessian<3> positive_volume_hessian(const Eigen::Matrix3d& f, double shear, double slope, double curvature) {
  const StretchAxes axes(f);
  const Eigen::Vector3d& s = axes.stretches;
  DeformationHessian<3> h = DeformationHessian<3>::Zero();
  const auto add = [&](double eigenvalue, const Eigen::Matrix3d& mode) {
    if (!(eigenvalue > 0)) return;
    const Eigen::Matrix<double, 9, 1> d = mode.reshaped();
    h.noalias() += (eigenvalue * d) * d.transpose();
  };
  Eigen::Matrix3d scaling;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Eigen::Matrix3d ij = std::sqrt(0.5) * axes.u.col(i) * axes.v.col(j).transpose(),
                          ji = std::sqrt(0.5) * axes.u.col(j) * axes.v.col(i).transpose();
    add(shear + slope * s[k], ij - ji);
    add(shear - slope * s[k], ij + ji);
    scaling(k, k) = shear + curvature * (s[i] * s[j]) * (s[i] * s[j]);
    scaling(i, j) = scaling(j, i) = slope * s[k] + curvature * (s[j] * s[k]) * (s[i] * s[k]);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scaling);
  for (int n = 0; n < 3; ++n)
    add(eigen.eigenvalues()[n], axes.u * eigen.eigenvectors().col(n).asDiagonal() * axes.v.transpose());
  return h;
}

}  // namespace selvage
