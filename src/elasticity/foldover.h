#pragma once

#include "selvage/core/types.h"

#include <Eigen/Core>

namespace selvage {

/// An energy without unit that makes inverted elements positive, and keeps positive ones so:
///
///     |F|^2 / chi^(2/3) + (J^2 + 1) / chi,   chi = (J + sqrt(J^2 + epsilon^2)) / 2,   J = det F.
///
/// Least at a rotation. For an inverted element it is finite, but the larger the smaller epsilon is.
/// Source: Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, Foldover-free maps in 50 lines of code.
struct FoldoverEnergy {
  double squared_epsilon = 1;

  double energy_density(const Eigen::Matrix3d& f) const;
  Eigen::Matrix3d first_piola(const Eigen::Matrix3d& f) const;

  /// Energy density and its derivatives by the position of one vertex.
  struct VertexDerivatives {
    double energy;
    Vec3 gradient;
    Eigen::Matrix3d hessian;  ///< positive definite: terms that may be negative are left out
  };
  /// @param b  see vertex_gradient()
  VertexDerivatives by_vertex(const Eigen::Matrix3d& f, const Vec3& b) const;
};

}  // namespace selvage
