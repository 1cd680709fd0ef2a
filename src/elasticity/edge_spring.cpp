#include "elasticity/edge_spring.h"

#include <algorithm>

namespace selvage {

namespace {

/// @param across  stiffness across the edge, as a part of that along it
StencilHessian<2> hessian_of(const Eigen::Vector3d& direction, double stiffness, double across) {
  const Eigen::Matrix3d along = direction * direction.transpose();
  const Eigen::Matrix3d block = stiffness * (along + across * (Eigen::Matrix3d::Identity() - along));
  StencilHessian<2> h;
  h << block, -block, -block, block;
  return h;
}

}  // namespace

double EdgeSpring::energy(const StencilPositions<2>& x) const {
  const double change = (x.col(1) - x.col(0)).norm() - length;
  return stiffness / 2 * change * change;
}

StencilGradient<2> EdgeSpring::gradient(const StencilPositions<2>& x) const {
  const Eigen::Vector3d edge = x.col(1) - x.col(0);
  const double now = edge.norm();
  const Eigen::Vector3d pull = now > 0 ? Eigen::Vector3d(stiffness * (now - length) / now * edge) : edge;
  StencilGradient<2> g;
  g << -pull, pull;
  return g;
}

StencilHessian<2> EdgeSpring::hessian(const StencilPositions<2>& x) const {
  const Eigen::Vector3d edge = x.col(1) - x.col(0);
  const double now = edge.norm();
  if (!(now > 0)) return hessian_of(edge, stiffness, 0);
  return hessian_of(edge / now, stiffness, 1 - length / now);
}

StencilHessian<2> EdgeSpring::positive_hessian(const StencilPositions<2>& x) const {
  const Eigen::Vector3d edge = x.col(1) - x.col(0);
  const double now = edge.norm();
  if (!(now > 0)) return hessian_of(edge, stiffness, 0);
  return hessian_of(edge / now, stiffness, std::max(1 - length / now, 0.0));
}

}  // namespace selvage
