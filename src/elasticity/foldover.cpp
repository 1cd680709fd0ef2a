#include "elasticity/foldover.h"

#include "elasticity/deformation_gradient.h"

#include <cmath>

namespace selvage {

namespace {

/// The two terms of the energy, and what its derivatives need of them.
struct Terms {
  double chi, chi_slope;  ///< and its derivative by J
  double scale;           ///< chi^(-2/3)
  double shape, size;     ///< first and second term
  double by_volume;       ///< derivative of the energy by J, where |F|^2 stays

  Terms(const Eigen::Matrix3d& f, double squared_epsilon) {
    const double volume = f.determinant(), root = std::sqrt(volume * volume + squared_epsilon);
    // Of two forms that are equal but for rounding, the one in which nothing cancels.
    chi = volume > 0 ? (volume + root) / 2 : squared_epsilon / (2 * (root - volume));
    const double chi_2_3 = std::cbrt(chi * chi);
    shape = f.squaredNorm() / chi_2_3;
    size = (volume * volume + 1) / chi;
    chi_slope = (1 + volume / root) / 2;
    scale = 1 / chi_2_3;
    by_volume = -2.0 / 3 * shape / chi * chi_slope + 2 * volume / chi - size / chi * chi_slope;
  }
};

}  // namespace

double FoldoverEnergy::energy_density(const Eigen::Matrix3d& f) const {
  const Terms terms(f, squared_epsilon);
  return terms.shape + terms.size;
}

Eigen::Matrix3d FoldoverEnergy::first_piola(const Eigen::Matrix3d& f) const {
  const Terms terms(f, squared_epsilon);
  return 2 * terms.scale * f + terms.by_volume * cofactors_of(f);
}

// J is linear in each vertex.
FoldoverEnergy::VertexDerivatives FoldoverEnergy::by_vertex(const Eigen::Matrix3d& f, const Vec3& b) const {
  const Terms terms(f, squared_epsilon);
  const double shape = terms.shape, size = terms.size, scale = terms.scale;
  const Vec3 c = cofactors_of(f) * b;
  const double steep = terms.chi_slope / terms.chi;
  VertexDerivatives result;
  result.energy = shape + size;
  result.gradient = 2 * scale * f * b + terms.by_volume * c;
  result.hessian = 2 * scale * b.squaredNorm() * Eigen::Matrix3d::Identity() +
                   (10.0 / 9 * shape * steep * steep + 2 * size * steep * steep) * c * c.transpose();
  return result;
}

}  // namespace selvage
