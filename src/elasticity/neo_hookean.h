#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// The Neo-Hookean Material: mu/2 (|F|^2 - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2 with J = det F, which is 0 at
/// rest. Up to a constant, the energy of Macklin and Mueller 2021; the XPBD solver has it as two constraints.
struct NeoHookean {
  double mu, lambda;  ///< Lame's parameters [Pa]

  static NeoHookean of(double youngs_modulus, double poisson_ratio);

  double energy_density(const Eigen::Matrix3d& f) const;
  Eigen::Matrix3d first_piola(const Eigen::Matrix3d& f) const;
  DeformationHessian<3> hessian(const Eigen::Matrix3d& f) const;
  /// The nearest that is positive semi-definite: see positive_volume_hessian().
  DeformationHessian<3> positive_hessian(const Eigen::Matrix3d& f) const;
  /// Exact: J is linear in one vertex, so that nothing is negative.
  VertexDerivatives by_vertex(const Eigen::Matrix3d& f, const Eigen::Vector3d& b) const {
    const Eigen::Matrix3d cofactors = cofactors_of(f);
    const Eigen::Vector3d c = cofactors * b;
    const double growth = f.col(0).dot(cofactors.col(0)) - 1;
    return {mu * f * b + slope(growth) * c,
            mu * b.squaredNorm() * Eigen::Matrix3d::Identity() + (lambda + mu) * c * c.transpose()};
  }

 private:
  double slope(double growth) const { return (lambda + mu) * growth - mu; }
};

static_assert(VertexMaterial<NeoHookean, 3>);

}  // namespace selvage
