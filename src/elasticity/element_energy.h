#pragma once

#include "elasticity/deformation_gradient.h"

#include <concepts>

namespace selvage {

/// A hyperelastic material of tetrahedra: its energy for each deformation gradient F.
template <typename Material>
concept TetrahedralMaterial = requires(const Material& material, const Eigen::Matrix3d& f) {
  /// Energy per rest volume [J/m^3].
  { material.energy_density(f) } -> std::convertible_to<double>;
  /// First Piola-Kirchhoff stress: the derivative of the energy density by F [Pa].
  { material.first_piola(f) } -> std::convertible_to<Eigen::Matrix3d>;
};

/// Elastic energy of an element [J].
template <TetrahedralMaterial Material>
double element_energy(const Material& material, const VertexTuple<4>& element, std::span<const Vec3> rest,
                      std::span<const Vec3> positions) {
  const Eigen::Matrix3d rest_edges = element_edges(element, rest);
  const Eigen::Matrix3d f = element_edges(element, positions) * rest_edges.inverse();
  return material.energy_density(f) * rest_edges.determinant() / 6;
}

/// Gradient of the elastic energy of an element by the positions of its vertices: forces the other way round [N].
template <TetrahedralMaterial Material>
std::array<Vec3, 4> element_gradient(const Material& material, const VertexTuple<4>& element,
                                     std::span<const Vec3> rest, std::span<const Vec3> positions) {
  const Eigen::Matrix3d rest_edges = element_edges(element, rest);
  const Eigen::Matrix3d inverse_edges = rest_edges.inverse();
  const Eigen::Matrix3d f = element_edges(element, positions) * inverse_edges;
  const Eigen::Matrix3d columns = rest_edges.determinant() / 6 * material.first_piola(f) * inverse_edges.transpose();
  return {Vec3(-columns.rowwise().sum()), Vec3(columns.col(0)), Vec3(columns.col(1)), Vec3(columns.col(2))};
}

}  // namespace selvage
