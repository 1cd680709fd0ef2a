#pragma once

#include <Eigen/Core>

#include <concepts>

namespace selvage {

/// Positions of the vertices of a stencil, as columns [m].
template <int N>
using StencilPositions = Eigen::Matrix<double, 3, N>;
/// Derivative of an energy by them, as columns [N].
template <int N>
using StencilGradient = Eigen::Matrix<double, 3, N>;
/// Second derivatives, coordinate by coordinate of vertex by vertex [N/m].
template <int N>
using StencilHessian = Eigen::Matrix<double, 3 * N, 3 * N>;

/// An energy of a few vertices: the one form in which solvers see materials of tetrahedra and triangles, springs,
/// bending and damping.
///
/// Finite for all finite positions. Where an energy has a kink (a spring of no length), the gradient is one of those on
/// its sides, and the Hessian leaves out what is infinite.
template <typename Energy>
concept StencilEnergy = requires(const Energy& energy, const StencilPositions<Energy::kVertices>& x) {
  /// [J]
  { energy.energy(x) } -> std::convertible_to<double>;
  { energy.gradient(x) } -> std::convertible_to<StencilGradient<Energy::kVertices>>;
  /// Exact: may have negative eigenvalues.
  { energy.hessian(x) } -> std::convertible_to<StencilHessian<Energy::kVertices>>;
  /// Positive semi-definite, and not below the exact one; the same near a minimum without stress.
  { energy.positive_hessian(x) } -> std::convertible_to<StencilHessian<Energy::kVertices>>;
};

}  // namespace selvage
