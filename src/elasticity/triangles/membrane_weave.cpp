#include "elasticity/triangles/membrane_weave.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace selvage {

namespace {

/// Second derivative of stiffness/2 (|w| - 1)^2.
Eigen::Matrix3d stretch_hessian(const Eigen::Vector3d& w, double stiffness, bool positive) {
  const double length = w.norm();
  if (!(length > 0)) return Eigen::Matrix3d::Zero();
  const Eigen::Matrix3d along = w * w.transpose() / (length * length);
  const double across = positive ? std::max(1 - 1 / length, 0.0) : 1 - 1 / length;
  return stiffness * (along + across * (Eigen::Matrix3d::Identity() - along));
}

Eigen::Vector3d stretch_gradient(const Eigen::Vector3d& w, double stiffness) {
  const double length = w.norm();
  return length > 0 ? Eigen::Vector3d(stiffness * (1 - 1 / length) * w) : Eigen::Vector3d(w);
}

double stretch_energy(const Eigen::Vector3d& w, double stiffness) {
  const double change = w.norm() - 1;
  return stiffness / 2 * change * change;
}

}  // namespace

double MembraneWeave::energy_density(const DeformationGradient<2>& f) const {
  const double angle = f.col(0).dot(f.col(1));
  return stretch_energy(f.col(0), warp) + stretch_energy(f.col(1), weft) + shear / 2 * angle * angle;
}

DeformationGradient<2> MembraneWeave::first_piola(const DeformationGradient<2>& f) const {
  const double angle = f.col(0).dot(f.col(1));
  DeformationGradient<2> stress;
  stress << stretch_gradient(f.col(0), warp) + shear * angle * f.col(1),
      stretch_gradient(f.col(1), weft) + shear * angle * f.col(0);
  return stress;
}

DeformationHessian<2> MembraneWeave::hessian(const DeformationGradient<2>& f) const {
  const double angle = f.col(0).dot(f.col(1));
  Eigen::Matrix<double, 6, 1> g;
  g << f.col(1), f.col(0);
  DeformationHessian<2> h = shear * g * g.transpose();
  h.block<3, 3>(0, 0) += stretch_hessian(f.col(0), warp, false);
  h.block<3, 3>(3, 3) += stretch_hessian(f.col(1), weft, false);
  h.block<3, 3>(0, 3) += shear * angle * Eigen::Matrix3d::Identity();
  h.block<3, 3>(3, 0) += shear * angle * Eigen::Matrix3d::Identity();
  return h;
}

// The shear term has no short eigensystem where both columns differ in length: it is found numerically.
DeformationHessian<2> MembraneWeave::positive_hessian(const DeformationGradient<2>& f) const {
  const double angle = f.col(0).dot(f.col(1));
  Eigen::Matrix<double, 6, 1> g;
  g << f.col(1), f.col(0);
  DeformationHessian<2> sheared = g * g.transpose();
  sheared.block<3, 3>(0, 3) += angle * Eigen::Matrix3d::Identity();
  sheared.block<3, 3>(3, 0) += angle * Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<DeformationHessian<2>> eigen(sheared);
  DeformationHessian<2> h =
      shear * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
  h.block<3, 3>(0, 0) += stretch_hessian(f.col(0), warp, true);
  h.block<3, 3>(3, 3) += stretch_hessian(f.col(1), weft, true);
  return h;
}

// The product w_u . w_v has the slope g and in all directions the curvature 2 b_u b_v.
VertexDerivatives MembraneWeave::by_vertex(const DeformationGradient<2>& f, const Eigen::Vector2d& b) const {
  const double angle = f.col(0).dot(f.col(1)), bend = 2 * angle * b[0] * b[1];
  const Eigen::Vector3d g = b[0] * f.col(1) + b[1] * f.col(0);
  const double squared = g.squaredNorm();
  VertexDerivatives own{
      b[0] * stretch_gradient(f.col(0), warp) + b[1] * stretch_gradient(f.col(1), weft) + shear * angle * g,
      b[0] * b[0] * stretch_hessian(f.col(0), warp, true) + b[1] * b[1] * stretch_hessian(f.col(1), weft, true)};
  if (bend >= 0)
    own.hessian += shear * (g * g.transpose() + bend * Eigen::Matrix3d::Identity());
  else if (squared + bend > 0)
    own.hessian += shear * (1 + bend / squared) * g * g.transpose();
  return own;
}

}  // namespace selvage
