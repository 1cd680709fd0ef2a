#include "elasticity/neo_hookean.h"

#include "elasticity/deformation_gradient.h"
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
  const double growth = f.determinant() - 1;
  return mu * f + ((lambda + mu) * growth - mu) * cofactors_of(f);
}

}  // namespace selvage
