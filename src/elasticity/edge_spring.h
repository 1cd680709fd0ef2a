#pragma once

#include "elasticity/stencil.h"

namespace selvage {

/// A spring along an edge: stiffness/2 (|x1 - x0| - length)^2. Where both ends are in one place, it has no direction,
/// and no force.
struct EdgeSpring {
  static constexpr int kVertices = 2;

  double stiffness;  ///< [N/m] 1 / Material::edge_compliance
  double length;     ///< at rest, or of least damping: at the start of the step [m]

  double energy(const StencilPositions<2>& x) const;
  StencilGradient<2> gradient(const StencilPositions<2>& x) const;
  StencilHessian<2> hessian(const StencilPositions<2>& x) const;
  /// The nearest that is positive semi-definite: without the push aside of a spring that is pressed.
  StencilHessian<2> positive_hessian(const StencilPositions<2>& x) const;
};

static_assert(StencilEnergy<EdgeSpring>);

}  // namespace selvage
