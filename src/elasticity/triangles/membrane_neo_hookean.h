#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// A Neo-Hookean sheet: mu/2 (|F|^2 - 2) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2, with J the ratio of areas. It is 0
/// at rest, where small strains are Hooke's law in the plane; finite and without a barrier for a triangle without area.
/// A sheet of thickness t in plane stress has mu = t E / (2 (1 + nu)) and lambda = t E nu / (1 - nu^2).
///
/// A triangle without area has no normal: there the gradient takes one of those across its longest edge; a triangle in
/// one point stays there.
/// Source: the energy of Smith, de Goes, Kim 2018 without its barrier, with J the area of the two columns of F.
struct MembraneNeoHookean {
  double mu, lambda;  ///< [N/m]

  double energy_density(const DeformationGradient<2>& f) const;
  DeformationGradient<2> first_piola(const DeformationGradient<2>& f) const;
  DeformationHessian<2> hessian(const DeformationGradient<2>& f) const;
  /// The nearest that is positive semi-definite, by its eigensystem in closed form.
  DeformationHessian<2> positive_hessian(const DeformationGradient<2>& f) const;
  /// Exact, but that it leaves out how a pressed sheet gives way across itself.
  VertexDerivatives by_vertex(const DeformationGradient<2>& f, const Eigen::Vector2d& b) const;

 private:
  double slope(double area) const { return (lambda + mu) * (area - 1) - mu; }
};

static_assert(VertexMaterial<MembraneNeoHookean, 2>);

}  // namespace selvage
