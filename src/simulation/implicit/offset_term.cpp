#include "simulation/implicit/offset_term.h"

#include "elasticity/edge_spring.h"

#include <algorithm>

namespace selvage {

namespace {

/// Slips from which on friction does not depend on how far a point slides, for the Hessian.
constexpr double kClearlySliding = 10;

StencilPositions<2> ends_of(const Vec3& u) {
  StencilPositions<2> x = StencilPositions<2>::Zero();
  x.col(1) = u;
  return x;
}

}  // namespace

Vec3 OffsetTerm::offset(std::span<const Vec3> positions) const {
  Vec3 u = -origin;
  for (int i = 0; i < count; ++i) u += weights[i] * positions[vertices[i]];
  return u;
}

double OffsetTerm::normal_force(const Vec3& u) const {
  return stiffness * std::max(target - normal.dot(u), 0.0);
}

// Friction: force f1(y) with y the slide by the slip, f1 = 2 y - y^2 up to 1, where it stays.
double OffsetTerm::energy(const Vec3& u) const {
  if (is_spring()) return EdgeSpring{stiffness, length}.energy(ends_of(u));
  const double depth = std::max(target - normal.dot(u), 0.0);
  double energy = stiffness / 2 * depth * depth;
  if (friction_force > 0) {
    const double y = slide(u).norm() / slip;
    energy += friction_force * slip * (y < 1 ? y * y - y * y * y / 3 : y - 1.0 / 3);
  }
  return energy;
}

OffsetTerm::Derivatives OffsetTerm::derivatives(const Vec3& u) const {
  if (is_spring()) {
    const EdgeSpring spring{stiffness, length};
    const StencilPositions<2> x = ends_of(u);
    return {spring.gradient(x).col(1), spring.positive_hessian(x).bottomRightCorner<3, 3>()};
  }
  Derivatives result{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  const double depth = target - normal.dot(u);
  if (depth > 0) {
    result.gradient = -stiffness * depth * normal;
    result.hessian = stiffness * normal * normal.transpose();
  }
  if (friction_force > 0) {
    const Vec3 across = slide(u);
    const double y = across.norm() / slip;
    // f1 by the slide, which near rest is not divided by it.
    const double secant = friction_force / slip * (y < 1 ? 2 - y : 1 / y);
    result.gradient += secant * across;
    result.hessian += secant * (Eigen::Matrix3d::Identity() - normal * normal.transpose());
    if (y > kClearlySliding) result.hessian -= secant / across.squaredNorm() * across * across.transpose();
  }
  return result;
}

void OffsetTerm::renew_friction(const Vec3& u, double most) {
  if (is_spring()) return;
  friction_force = coefficient * std::min(normal_force(u), most);
}

}  // namespace selvage
