#pragma once

#include "elasticity/deformation_gradient.h"
#include "elasticity/stencil.h"

namespace selvage {

/// Deformation gradient: the present edges of a simplex of dimension D by those of its rest shape in D dimensions.
template <int D>
using DeformationGradient = Eigen::Matrix<double, 3, D>;
/// Second derivatives by a deformation gradient, column after column.
template <int D>
using DeformationHessian = Eigen::Matrix<double, 3 * D, 3 * D>;

/// Derivatives of a density by the position of one vertex: see RestSimplex::by_vertex().
struct VertexDerivatives {
  Eigen::Vector3d gradient;
  Eigen::Matrix3d hessian;  ///< positive semi-definite
};

/// An energy density for each deformation gradient. D is 3 for tetrahedra, where it is per volume at rest [J/m^3], and
/// 2 for triangles, where it is per area [J/m^2].
template <typename Density, int D>
concept EnergyDensity = requires(const Density& density, const DeformationGradient<D>& f) {
  { density.energy_density(f) } -> std::convertible_to<double>;
  /// First Piola-Kirchhoff stress: the derivative of the density by F.
  { density.first_piola(f) } -> std::convertible_to<DeformationGradient<D>>;
};

/// One with its second derivatives: a hyperelastic material.
template <typename Material, int D>
concept HyperelasticMaterial = EnergyDensity<Material, D> &&
    requires(const Material& material, const DeformationGradient<D>& f) {
  { material.hessian(f) } -> std::convertible_to<DeformationHessian<D>>;
  /// As in StencilEnergy.
  { material.positive_hessian(f) } -> std::convertible_to<DeformationHessian<D>>;
};

/// One that also gives what solvers need that move a single vertex.
template <typename Material, int D>
concept VertexMaterial = HyperelasticMaterial<Material, D> &&
    requires(const Material& material, const DeformationGradient<D>& f, const Eigen::Matrix<double, D, 1>& b) {
  { material.by_vertex(f, b) } -> std::convertible_to<VertexDerivatives>;
};

/// A tetrahedron (D = 3) or triangle (D = 2) at rest.
template <int D>
struct RestSimplex {
  static constexpr int kVertices = D + 1;

  Eigen::Matrix<double, D, D> inverse_edges;  ///< of the edges from vertex 0 at rest, as columns [1/m]
  double size;                                ///< volume [m^3] or area [m^2]

  /// @param edges  from vertex 0 at rest, in D dimensions, of positive determinant
  static RestSimplex of(const Eigen::Matrix<double, D, D>& edges) {
    return {edges.inverse(), edges.determinant() / (D == 3 ? 6 : 2)};
  }

  DeformationGradient<D> deformation(const StencilPositions<D + 1>& x) const {
    return (x.template rightCols<D>().colwise() - x.col(0)) * inverse_edges;
  }
  /// Where vertex k moves by x, the deformation gradient changes by x b^T, with b returned.
  Eigen::Matrix<double, D, 1> by_vertex(int k) const {
    if (k > 0) return inverse_edges.row(k - 1).transpose();
    return -inverse_edges.colwise().sum().transpose();
  }

  StencilGradient<D + 1> gradient_of(const DeformationGradient<D>& stress) const {
    StencilGradient<D + 1> gradient;
    gradient.template rightCols<D>() = size * stress * inverse_edges.transpose();
    gradient.col(0) = -gradient.template rightCols<D>().rowwise().sum();
    return gradient;
  }

  StencilHessian<D + 1> hessian_of(const DeformationHessian<D>& h) const {
    StencilHessian<D + 1> result;
    std::array<Eigen::Matrix<double, D, 1>, D + 1> b;
    for (int k = 1; k <= D; ++k) b[k] = by_vertex(k);
    // It is symmetric, and moving all vertices alike changes nothing: vertex 0 has what the others leave.
    for (int l = 1; l <= D; ++l) {
      Eigen::Matrix<double, 3 * D, 3> columns = size * b[l][0] * h.template leftCols<3>();
      for (int j = 1; j < D; ++j) columns += size * b[l][j] * h.template middleCols<3>(3 * j);
      for (int k = l; k <= D; ++k) {
        Eigen::Matrix3d block = b[k][0] * columns.template topRows<3>();
        for (int i = 1; i < D; ++i) block += b[k][i] * columns.template middleRows<3>(3 * i);
        result.template block<3, 3>(3 * k, 3 * l) = block;
        if (k > l) result.template block<3, 3>(3 * l, 3 * k) = block.transpose();
      }
    }
    for (int k = D; k >= 0; --k) {
      Eigen::Matrix3d rest = Eigen::Matrix3d::Zero();
      for (int l = 1; l <= D; ++l) rest -= result.template block<3, 3>(3 * k, 3 * l);
      result.template block<3, 3>(3 * k, 0) = rest;
      if (k > 0) result.template block<3, 3>(0, 3 * k) = rest.transpose();
    }
    return result;
  }
};

/// The vertices of an element.
template <std::size_t N>
StencilPositions<static_cast<int>(N)> gather(const std::array<Index, N>& element, std::span<const Vec3> positions) {
  StencilPositions<static_cast<int>(N)> x;
  for (std::size_t k = 0; k < N; ++k) x.col(k) = positions[element[k]];
  return x;
}

/// A tetrahedron at rest.
inline RestSimplex<3> rest_tetrahedron(const VertexTuple<4>& element, std::span<const Vec3> rest) {
  return RestSimplex<3>::of(element_edges(element, rest));
}

/// The elastic energy of one element: its material over its rest shape.
template <int D, EnergyDensity<D> Material>
struct SimplexElement {
  static constexpr int kVertices = D + 1;

  RestSimplex<D> rest;
  Material material;

  double energy(const StencilPositions<D + 1>& x) const {
    return rest.size * material.energy_density(rest.deformation(x));
  }
  StencilGradient<D + 1> gradient(const StencilPositions<D + 1>& x) const {
    return rest.gradient_of(material.first_piola(rest.deformation(x)));
  }
  StencilHessian<D + 1> hessian(const StencilPositions<D + 1>& x) const requires HyperelasticMaterial<Material, D> {
    return rest.hessian_of(material.hessian(rest.deformation(x)));
  }
  StencilHessian<D + 1> positive_hessian(const StencilPositions<D + 1>& x) const requires
      HyperelasticMaterial<Material, D> {
    return rest.hessian_of(material.positive_hessian(rest.deformation(x)));
  }
};

}  // namespace selvage
