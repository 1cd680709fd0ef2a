#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// A woven sheet: warp/2 (|w_u| - 1)^2 + weft/2 (|w_v| - 1)^2 + shear/2 (w_u . w_v)^2 per area, where w_u and w_v are
/// the columns of F: how far warp and weft are stretched, and by how much they are no longer across one another. The
/// edges at rest are given with the warp along the first axis.
///
/// Where warp or weft has no length, it has no direction and no force.
/// Source: Baraff and Witkin 1998, Large steps in cloth simulation, sections 4.2 and 4.3; per area, not per squared
/// area, so that a finer mesh is as stiff as a coarse one.
struct MembraneWeave {
  double warp, weft, shear;  ///< [N/m]

  double energy_density(const DeformationGradient<2>& f) const;
  DeformationGradient<2> first_piola(const DeformationGradient<2>& f) const;
  DeformationHessian<2> hessian(const DeformationGradient<2>& f) const;
  /// Each term without its negative eigenvalues.
  DeformationHessian<2> positive_hessian(const DeformationGradient<2>& f) const;
  /// Each term without its negative eigenvalues.
  VertexDerivatives by_vertex(const DeformationGradient<2>& f, const Eigen::Vector2d& b) const;
};

static_assert(VertexMaterial<MembraneWeave, 2>);

}  // namespace selvage
