#include "elasticity/strain_damping.h"

#include <Eigen/Eigenvalues>

namespace selvage {

// F moves by dF: the strain by the symmetric part of F^T dF, and the stress stays with dF.
template <int D>
DeformationHessian<D> StrainDamping<D>::hessian_with(const DeformationGradient<D>& f, const Strain& stress) const {
  DeformationHessian<D> h;
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      Eigen::Matrix3d block = lambda * f.col(a) * f.col(b).transpose() + mu * f.col(b) * f.col(a).transpose() +
                              stress(a, b) * Eigen::Matrix3d::Identity();
      if (a == b)
        for (int c = 0; c < D; ++c) block += mu * f.col(c) * f.col(c).transpose();
      h.template block<3, 3>(3 * a, 3 * b) = block;
    }
  return h;
}

template <int D>
DeformationHessian<D> StrainDamping<D>::positive_hessian(const DeformationGradient<D>& f) const {
  const Eigen::SelfAdjointEigenSolver<Strain> eigen(stress_of(change_of(f)));
  const Strain pulling =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
  return hessian_with(f, pulling);
}

template struct StrainDamping<2>;
template struct StrainDamping<3>;

}  // namespace selvage
