#pragma once

#include <Eigen/Core>

namespace selvage {

/// The Neo-Hookean Material: mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2 with J = det F, which is 0 at
/// rest. Up to a constant, the energy of Macklin and Mueller 2021; the XPBD solver has it as two constraints.
struct NeoHookean {
  double mu, lambda;  ///< Lame's parameters [Pa]

  static NeoHookean of(double youngs_modulus, double poisson_ratio);

  double energy_density(const Eigen::Matrix3d& f) const;
  Eigen::Matrix3d first_piola(const Eigen::Matrix3d& f) const;
};

}  // namespace selvage
