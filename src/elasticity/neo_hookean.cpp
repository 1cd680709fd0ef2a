#include "elasticity/neo_hookean.h"

#include "elasticity/deformation_gradient.h"
#include "elasticity/volume_hessian.h"
#include "selvage/elasticity/material.h"

namespace selvage {

NeoHookean NeoHookean::of(double youngs_modulus, double poisson_ratio) {
  const auto [mu, lambda] = lame_parameters(youngs_modulus, poisson_ratio);
  return {mu, lambda};
}

// By J - 1, not by J: near rest the large terms cancel.
double NeoHookean::energy_density(const Eigen::Matrix3d& f) const {
  const double growth = f.determinant() - 1;
  return mu / 2 * (f.squaredNorm() - 3) - mu * growth + (lambda + mu) / 2 * growth * growth;
}

Eigen::Matrix3d NeoHookean::first_piola(const Eigen::Matrix3d& f) const {
  return mu * f + slope(f.determinant() - 1) * cofactors_of(f);
}

DeformationHessian<3> NeoHookean::hessian(const Eigen::Matrix3d& f) const {
  return volume_hessian(f, mu, slope(f.determinant() - 1), lambda + mu);
}

DeformationHessian<3> NeoHookean::positive_hessian(const Eigen::Matrix3d& f) const {
  return positive_volume_hessian(f, mu, slope(f.determinant() - 1), lambda + mu);
}

}  // namespace selvage
