#pragma once

#include "elasticity/simplex_element.h"

#include <algorithm>

namespace selvage {

/// Damping of an element over a time step, as an energy: mu |E|^2 + lambda/2 tr(E)^2, with E = (F^T F - F_t^T F_t) / 2
/// the change of Green's strain since the start of the step. With the Lame parameters of the material times
/// Material::damping over the step, stretching at a rate r is resisted like a stretch of damping * r.
///
/// It depends on lengths and angles within the element alone: rigid motion costs nothing, and its forces have neither
/// resultant nor moment.
template <int D>
struct StrainDamping {
  double mu, lambda;                          ///< [Pa], for triangles [N/m]
  Eigen::Matrix<double, D, D> squared_start;  ///< F_t^T F_t

  double energy_density(const DeformationGradient<D>& f) const {
    const Strain e = change_of(f);
    return mu * e.squaredNorm() + lambda / 2 * e.trace() * e.trace();
  }
  DeformationGradient<D> first_piola(const DeformationGradient<D>& f) const { return f * stress_of(change_of(f)); }
  DeformationHessian<D> hessian(const DeformationGradient<D>& f) const {
    return hessian_with(f, stress_of(change_of(f)));
  }
  /// Without the part of a stress that presses.
  DeformationHessian<D> positive_hessian(const DeformationGradient<D>& f) const;
  /// Without the stress along b where it presses.
  VertexDerivatives by_vertex(const DeformationGradient<D>& f, const Eigen::Matrix<double, D, 1>& b) const {
    const Strain stress = stress_of(change_of(f));
    const Eigen::Vector3d c = f * b;
    const Eigen::Matrix3d spread = mu * b.squaredNorm() * f * f.transpose();
    return {f * (stress * b), (lambda + mu) * c * c.transpose() + spread +
                                  std::max(b.dot(stress * b), 0.0) * Eigen::Matrix3d::Identity()};
  }

 private:
  using Strain = Eigen::Matrix<double, D, D>;

  Strain change_of(const DeformationGradient<D>& f) const { return 0.5 * (f.transpose() * f - squared_start); }
  /// Second Piola-Kirchhoff stress.
  Strain stress_of(const Strain& e) const { return 2 * mu * e + lambda * e.trace() * Strain::Identity(); }
  DeformationHessian<D> hessian_with(const DeformationGradient<D>& f, const Strain& stress) const;
};

extern template struct StrainDamping<2>;
extern template struct StrainDamping<3>;

static_assert(VertexMaterial<StrainDamping<2>, 2> && VertexMaterial<StrainDamping<3>, 3>);

}  // namespace selvage
