#include "elasticity/triangles/bending.h"

#include "elasticity/deformation_gradient.h"

#include <cmath>
#include <numbers>

namespace selvage {

namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;
using Jacobian = Eigen::Matrix<double, 3, 12>;  ///< of a vector by the four vertices
using Row = Eigen::Matrix<double, 1, 12>;       ///< of a number

/// Of the difference between a vertex and vertex 0.
Jacobian difference_to(int vertex) {
  Jacobian j = Jacobian::Zero();
  j.block<3, 3>(0, 3 * vertex).setIdentity();
  j.leftCols<3>() -= Matrix::Identity();
  return j;
}

struct Hinge {
  Vector edge, sides[2];  ///< from vertex 0: to 1, to 2 and 3
  Vector normals[2];      ///< twice the areas
  double squared_edge;

  explicit Hinge(const HingePositions& x) : edge(x.col(1) - x.col(0)), squared_edge(edge.squaredNorm()) {
    for (int k = 0; k < 2; ++k) sides[k] = x.col(k + 2) - x.col(0);
    normals[0] = edge.cross(sides[0]);
    normals[1] = sides[1].cross(edge);
  }
  bool is_proper() const { return squared_edge > 0 && normals[0].squaredNorm() > 0 && normals[1].squaredNorm() > 0; }

  double angle() const {
    if (!is_proper()) return 0;
    return std::atan2(normals[1].cross(normals[0]).dot(edge) / std::sqrt(squared_edge), normals[0].dot(normals[1]));
  }
  /// Of the angle by the vertex across in a triangle.
  Vector slope(int k) const { return std::sqrt(squared_edge) / normals[k].squaredNorm() * normals[k]; }
  /// Where along the edge that vertex stands: 0 at vertex 0, 1 at vertex 1.
  double foot(int k) const { return sides[k].dot(edge) / squared_edge; }

  StencilGradient<4> gradient() const {
    if (!is_proper()) return StencilGradient<4>::Zero();
    StencilGradient<4> g;
    g.col(2) = slope(0);
    g.col(3) = slope(1);
    g.col(0) = -(1 - foot(0)) * g.col(2) - (1 - foot(1)) * g.col(3);
    g.col(1) = -foot(0) * g.col(2) - foot(1) * g.col(3);
    return g;
  }

  Jacobian slope_jacobian(int k) const {
    const Jacobian of_edge = difference_to(1), of_side = difference_to(k + 2);
    const double sign = k == 0 ? 1 : -1, length = std::sqrt(squared_edge), squared = normals[k].squaredNorm();
    const Jacobian of_normal = sign * (cross_product_matrix(edge) * of_side - cross_product_matrix(sides[k]) * of_edge);
    const Vector& n = normals[k];
    return n / (squared * length) * (edge.transpose() * of_edge) + length / squared * of_normal -
           2 * length / (squared * squared) * n * (n.transpose() * of_normal);
  }
  Row foot_jacobian(int k) const {
    const Jacobian of_edge = difference_to(1), of_side = difference_to(k + 2);
    return (edge.transpose() * of_side + sides[k].transpose() * of_edge - 2 * foot(k) * edge.transpose() * of_edge) /
           squared_edge;
  }
  StencilHessian<4> hessian() const {
    StencilHessian<4> h = StencilHessian<4>::Zero();
    if (!is_proper()) return h;
    for (int k = 0; k < 2; ++k) {
      const Jacobian own = slope_jacobian(k);
      const Jacobian shared = slope(k) * foot_jacobian(k);
      h.middleRows<3>(3 * (k + 2)) = own;
      h.middleRows<3>(0) += shared - (1 - foot(k)) * own;
      h.middleRows<3>(3) -= shared + foot(k) * own;
    }
    return h;
  }
};

double cotangent(const Vector& a, const Vector& b) {
  return a.dot(b) / a.cross(b).norm();
}

}  // namespace

double hinge_angle(const HingePositions& x) {
  return Hinge(x).angle();
}

StencilGradient<4> hinge_angle_gradient(const HingePositions& x) {
  return Hinge(x).gradient();
}

HingeBending HingeBending::of(const HingePositions& rest, double sheet_stiffness) {
  const Hinge hinge(rest);
  const double area = (hinge.normals[0].norm() + hinge.normals[1].norm()) / 2;
  return {3 * sheet_stiffness * hinge.squared_edge / area, hinge.angle()};
}

double HingeBending::bent_by(const HingePositions& x) const {
  const Hinge hinge(x);
  if (!hinge.is_proper()) return 0;
  return -std::remainder(rest_angle - hinge.angle(), 2 * std::numbers::pi);
}

double HingeBending::energy(const HingePositions& x) const {
  const double bent = bent_by(x);
  return stiffness / 2 * bent * bent;
}

StencilGradient<4> HingeBending::gradient(const HingePositions& x) const {
  return stiffness * bent_by(x) * Hinge(x).gradient();
}

StencilHessian<4> HingeBending::positive_hessian(const HingePositions& x) const {
  const Eigen::Matrix<double, 12, 1> g = Hinge(x).gradient().reshaped();
  return stiffness * g * g.transpose();
}

VertexDerivatives HingeBending::by_vertex(const HingePositions& x, int vertex) const {
  const Eigen::Vector3d g = Hinge(x).gradient().col(vertex);
  return {stiffness * bent_by(x) * g, stiffness * g * g.transpose()};
}

StencilHessian<4> HingeBending::hessian(const HingePositions& x) const {
  return positive_hessian(x) + stiffness * bent_by(x) * Hinge(x).hessian();
}

QuadraticBending QuadraticBending::of(const HingePositions& rest, double sheet_stiffness) {
  const Hinge hinge(rest);
  const double area = (hinge.normals[0].norm() + hinge.normals[1].norm()) / 2;
  Eigen::Vector4d weights = Eigen::Vector4d::Zero();
  for (int k = 0; k < 2; ++k) {
    const double at_0 = cotangent(hinge.edge, hinge.sides[k]),
                 at_1 = cotangent(-hinge.edge, hinge.sides[k] - hinge.edge);
    weights[0] += at_1;
    weights[1] += at_0;
    weights[k + 2] = -at_0 - at_1;
  }
  return {3 * sheet_stiffness / area, weights};
}

StencilHessian<4> QuadraticBending::hessian(const HingePositions&) const {
  const Eigen::Matrix4d products = stiffness * weights * weights.transpose();
  StencilHessian<4> h;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) h.block<3, 3>(3 * a, 3 * b) = products(a, b) * Matrix::Identity();
  return h;
}

HingeDamping HingeDamping::of(const HingePositions& rest, double stiffness) {
  const Hinge hinge(rest);
  const double areas = hinge.normals[0].norm() * hinge.normals[1].norm();
  return {stiffness, std::sqrt(hinge.squared_edge) / areas, 0};
}

double HingeDamping::sine(const HingePositions& x) const {
  const Hinge hinge(x);
  return scale * hinge.sides[1].dot(hinge.normals[0]);
}

StencilGradient<4> HingeDamping::sine_gradient(const HingePositions& x) const {
  const Hinge hinge(x);
  StencilGradient<4> g;
  g.col(1) = scale * hinge.sides[0].cross(hinge.sides[1]);
  g.col(2) = scale * hinge.normals[1];
  g.col(3) = scale * hinge.normals[0];
  g.col(0) = -g.col(1) - g.col(2) - g.col(3);
  return g;
}

double HingeDamping::energy(const HingePositions& x) const {
  const double change = sine(x) - start;
  return stiffness / 2 * change * change;
}

StencilGradient<4> HingeDamping::gradient(const HingePositions& x) const {
  return stiffness * (sine(x) - start) * sine_gradient(x);
}

StencilHessian<4> HingeDamping::positive_hessian(const HingePositions& x) const {
  const Eigen::Matrix<double, 12, 1> g = sine_gradient(x).reshaped();
  return stiffness * g * g.transpose();
}

VertexDerivatives HingeDamping::by_vertex(const HingePositions& x, int vertex) const {
  const Vector g = sine_gradient(x).col(vertex);
  return {stiffness * (sine(x) - start) * g, stiffness * g * g.transpose()};
}

StencilHessian<4> HingeDamping::hessian(const HingePositions& x) const {
  const Hinge hinge(x);
  const Jacobian edge = difference_to(1), first = difference_to(2), second = difference_to(3);
  const Jacobian by_edge = cross_product_matrix(hinge.sides[0]) * second - cross_product_matrix(hinge.sides[1]) * first,
                 by_first = cross_product_matrix(hinge.sides[1]) * edge - cross_product_matrix(hinge.edge) * second,
                 by_second = cross_product_matrix(hinge.edge) * first - cross_product_matrix(hinge.sides[0]) * edge;
  const double pull = stiffness * (sine(x) - start) * scale;
  return positive_hessian(x) +
         pull * (edge.transpose() * by_edge + first.transpose() * by_first + second.transpose() * by_second);
}

}  // namespace selvage
