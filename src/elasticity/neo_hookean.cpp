#include "elasticity/neo_hookean.h"

#include "elasticity/deformation_gradient.h"
#include "selvage/elasticity/material.h"

namespace selvage {

double element_energy(const VertexTuple<4>& element, std::span<const Vec3> rest, std::span<const Vec3> positions,
                      double poisson_ratio) {
  const Eigen::Matrix3d rest_edges = element_edges(element, rest);
  const Eigen::Matrix3d gradient = element_edges(element, positions) * rest_edges.inverse();
  const auto [mu, lambda] = lame_parameters(1, poisson_ratio);
  const double growth = gradient.determinant() - 1;
  // Written out from rest, where the terms that cancel are large.
  const double density = mu / 2 * (gradient.squaredNorm() - 3) - mu * growth + (lambda + mu) / 2 * growth * growth;
  return density * rest_edges.determinant() / 6;
}

}  // namespace selvage
