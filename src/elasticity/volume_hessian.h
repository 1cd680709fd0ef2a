#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// Second derivative of shear/2 |F|^2 + f(J), J = det F, by F, where f has the given first and second derivative.
DeformationHessian<3> volume_hessian(const Eigen::Matrix3d& f, double shear, double slope, double curvature);

/// The same without its negative eigenvalues, by the eigensystem in closed form. With F = U S V^T, where U and V are
/// rotations: in each plane of two axes, turning both has the eigenvalue shear + s slope and shearing both
/// shear - s slope, with s the stretch along the third axis; the other three eigenvectors scale the axes, and are those
/// of a 3 x 3 matrix.
/// Source: Smith, de Goes, Kim 2018, Stable Neo-Hookean flesh simulation; Smith, de Goes, Kim 2019, Analytic
/// eigensystems for isotropic distortion energies.
DeformationHessian<3> positive_volume_hessian(const Eigen::Matrix3d& f, double shear, double slope, double curvature);

}  // namespace selvage
