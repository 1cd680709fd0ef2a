#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// The volume of an element of a mass-spring material: stiffness/2 (det F - ratio)^2 per rest volume.
struct VolumeSpring {
  double stiffness;  ///< [Pa] rest volume over Material::volume_compliance
  double ratio = 1;  ///< of least energy: 1, or for damping det F at the start of the step

  double energy_density(const Eigen::Matrix3d& f) const;
  Eigen::Matrix3d first_piola(const Eigen::Matrix3d& f) const;
  DeformationHessian<3> hessian(const Eigen::Matrix3d& f) const;
  DeformationHessian<3> positive_hessian(const Eigen::Matrix3d& f) const;
  /// Exact: J is linear in one vertex.
  VertexDerivatives by_vertex(const Eigen::Matrix3d& f, const Eigen::Vector3d& b) const {
    const Eigen::Vector3d c = cofactors_of(f) * b;
    return {stiffness * (f.determinant() - ratio) * c, stiffness * c * c.transpose()};
  }
};

static_assert(VertexMaterial<VolumeSpring, 3>);

}  // namespace selvage
