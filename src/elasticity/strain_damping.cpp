#include "elasticity/strain_damping.h"

#include "elasticity/axes.h"

#include <Eigen/Eigenvalues>

namespace selvage {

// F moves by dF: the strain by the symmetric part of F^T dF, and the stress stays with dF.
template <int D>
DeformationHessian<D> StrainDamping<D>::hessian_with(const DeformationGradient<D>& f, const Strain& stress) const {
  DeformationHessian<D> h;
  const Eigen::Matrix3d spread = mu * f * f.transpose();
  for (int a = 0; a < D; ++a)
    for (int b = 0; b <= a; ++b) {
      const Eigen::Matrix3d product = f.col(a) * f.col(b).transpose();
      Eigen::Matrix3d block = lambda * product + mu * product.transpose();
      block.diagonal().array() += stress(a, b);
      if (a == b) block += spread;
      h.template block<3, 3>(3 * a, 3 * b) = block;
      if (a != b) h.template block<3, 3>(3 * b, 3 * a) = block.transpose();
    }
  return h;
}

template <int D>
DeformationHessian<D> StrainDamping<D>::positive_hessian(const DeformationGradient<D>& f) const {
  const Strain stress = stress_of(change_of(f));
  if constexpr (D == 3) return hessian_with(f, SymmetricAxes(stress).positive_part());
  const Eigen::SelfAdjointEigenSolver<Strain> eigen(stress);
  const Strain pulling =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
  return hessian_with(f, pulling);
}

template struct StrainDamping<2>;
template struct StrainDamping<3>;

}  // namespace selvage
