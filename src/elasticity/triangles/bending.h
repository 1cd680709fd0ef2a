#pragma once

#include "elasticity/simplex_element.h"
#include "elasticity/stencil.h"

namespace selvage {

/// Vertices of two triangles with a common edge: its ends, then the one across in each. The first triangle is (0, 1,
/// 2), the second (1, 0, 3).
using HingePositions = StencilPositions<4>;

/// Angle between the two triangles' normals, in (-pi, pi]: 0 where they are flat, positive where they are folded
/// towards the side to which the normals point. 0 also where a triangle has no area.
double hinge_angle(const HingePositions& x);

/// How that angle changes with the vertices [1/m]; zero where a triangle has no area.
StencilGradient<4> hinge_angle_gradient(const HingePositions& x);

/// Bending over an edge: stiffness/2 (angle - rest_angle)^2, with the difference taken into (-pi, pi]. Where a triangle
/// has no area there is no force.
/// Source: Grinspun, Hirani, Desbrun, Schroeder 2003, Discrete shells; derivatives as in Tamstorf and Grinspun 2013.
struct HingeBending {
  static constexpr int kVertices = 4;

  double stiffness;   ///< [J]
  double rest_angle;  ///< [rad]

  /// Of a sheet: the stiffness is 3 sheet_stiffness |e|^2 / A, with e the edge and A the area of both triangles, so
  /// that small angles cost the same as with QuadraticBending.
  /// @param rest             as it is at rest, with triangles that have an area
  /// @param sheet_stiffness  [J]
  static HingeBending of(const HingePositions& rest, double sheet_stiffness);

  double energy(const HingePositions& x) const;
  StencilGradient<4> gradient(const HingePositions& x) const;
  StencilHessian<4> hessian(const HingePositions& x) const;
  /// Gauss-Newton: without the curvature of the angle itself.
  StencilHessian<4> positive_hessian(const HingePositions& x) const;
  /// Blocks of the gradient and of the positive Hessian.
  VertexDerivatives by_vertex(const HingePositions& x, int vertex) const;

 private:
  double bent_by(const HingePositions& x) const;
};

static_assert(StencilEnergy<HingeBending>);

/// Bending of a sheet that is flat at rest and hardly stretched: a quadratic form, so that its Hessian never changes.
/// Source: Bergou, Wardetzky, Harmon, Zorin, Grinspun 2006, A quadratic bending model for inextensible surfaces.
struct QuadraticBending {
  static constexpr int kVertices = 4;

  double stiffness;         ///< [J/m^2]
  Eigen::Vector4d weights;  ///< of the vertices: their weighed sum is 0 where the sheet is flat [1]

  /// @param rest  as it is at rest: flat, with triangles that have an area
  static QuadraticBending of(const HingePositions& rest, double sheet_stiffness);

  double energy(const HingePositions& x) const { return stiffness / 2 * (x * weights).squaredNorm(); }
  StencilGradient<4> gradient(const HingePositions& x) const { return stiffness * (x * weights) * weights.transpose(); }
  StencilHessian<4> hessian(const HingePositions& x) const;
  StencilHessian<4> positive_hessian(const HingePositions& x) const { return hessian(x); }
  VertexDerivatives by_vertex(const HingePositions& x, int vertex) const {
    const double pull = stiffness * weights[vertex];
    return {pull * (x * weights), pull * weights[vertex] * Eigen::Matrix3d::Identity()};
  }
};

static_assert(StencilEnergy<QuadraticBending>);

/// Damping of bending over a time step, as an energy: stiffness/2 (s - start)^2, where s is the sine of the hinge's
/// angle with edge and heights as they are at rest, and `start` that at the start of the step. With the hinge's
/// stiffness times the damping over the step, folding at a rate r is resisted like a fold by damping * r where the
/// cloth is nearly flat; less where it is folded further, nothing at a right angle.
///
/// s is six times the volume of the four vertices, over lengths: rigid motion does not change it, so that it costs
/// nothing, and forces have neither resultant nor moment. In one vertex s is linear.
struct HingeDamping {
  static constexpr int kVertices = 4;

  double stiffness;  ///< [J]
  double scale;      ///< s over six times the volume [1/m^3]
  double start;      ///< s at the start of the step [1]

  /// @param rest  as it is at rest, with triangles that have an area
  static HingeDamping of(const HingePositions& rest, double stiffness);

  double sine(const HingePositions& x) const;
  /// Of the sine.
  StencilGradient<4> sine_gradient(const HingePositions& x) const;

  double energy(const HingePositions& x) const;
  StencilGradient<4> gradient(const HingePositions& x) const;
  StencilHessian<4> hessian(const HingePositions& x) const;
  /// Gauss-Newton: without the curvature of the sine.
  StencilHessian<4> positive_hessian(const HingePositions& x) const;
  VertexDerivatives by_vertex(const HingePositions& x, int vertex) const;
};

static_assert(StencilEnergy<HingeDamping>);

}  // namespace selvage
