#include "elasticity/volume_spring.h"

#include "elasticity/deformation_gradient.h"
#include "elasticity/volume_hessian.h"

namespace selvage {

double VolumeSpring::energy_density(const Eigen::Matrix3d& f) const {
  const double growth = f.determinant() - ratio;
  return stiffness / 2 * growth * growth;
}

Eigen::Matrix3d VolumeSpring::first_piola(const Eigen::Matrix3d& f) const {
  return stiffness * (f.determinant() - ratio) * cofactors_of(f);
}

DeformationHessian<3> VolumeSpring::hessian(const Eigen::Matrix3d& f) const {
  return volume_hessian(f, 0, stiffness * (f.determinant() - ratio), stiffness);
}

DeformationHessian<3> VolumeSpring::positive_hessian(const Eigen::Matrix3d& f) const {
  return positive_volume_hessian(f, 0, stiffness * (f.determinant() - ratio), stiffness);
}

}  // namespace selvage
