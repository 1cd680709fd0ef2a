#include "simulation/implicit/offset_term.h"

#include "elasticity/edge_spring.h"

namespace selvage {

namespace {

StencilPositions<2> ends_of(const Vec3& u) {
  StencilPositions<2> x = StencilPositions<2>::Zero();
  x.col(1) = u;
  return x;
}

}  // namespace

double OffsetTerm::spring_energy(const Vec3& u) const {
  return EdgeSpring{stiffness, length}.energy(ends_of(u));
}

OffsetTerm::Derivatives OffsetTerm::spring_derivatives(const Vec3& u) const {
  const EdgeSpring spring{stiffness, length};
  const StencilPositions<2> x = ends_of(u);
  return {spring.gradient(x).col(1), spring.positive_hessian(x).bottomRightCorner<3, 3>()};
}

void OffsetTerm::renew_friction(const Vec3& u, double most) {
  if (is_spring()) return;
  friction_force = coefficient * std::min(force_at(depth(u)), most);
}

}  // namespace selvage
