#include "elasticity/triangles/membrane_neo_hookean.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

using Gradient = DeformationGradient<2>;

double area_of(const Gradient& f) {
  return f.col(0).cross(f.col(1)).norm();
}

/// Unit; across the longer column where the two are parallel.
Eigen::Vector3d normal_of(const Gradient& f) {
  const Eigen::Vector3d across = f.col(0).cross(f.col(1));
  const double length = across.norm();
  if (length > 0) return across / length;
  const Eigen::Vector3d longer = f.col(f.col(1).squaredNorm() > f.col(0).squaredNorm() ? 1 : 0);
  return longer.squaredNorm() > 0 ? longer.unitOrthogonal() : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
}

/// Derivative of the area.
Gradient cofactors_of_sheet(const Gradient& f) {
  const Eigen::Vector3d n = normal_of(f);
  Gradient cofactors;
  cofactors << f.col(1).cross(n), n.cross(f.col(0));
  return cofactors;
}

}  // namespace

double MembraneNeoHookean::energy_density(const Gradient& f) const {
  const double growth = area_of(f) - 1;
  return mu / 2 * (f.squaredNorm() - 2) - mu * growth + (lambda + mu) / 2 * growth * growth;
}

Gradient MembraneNeoHookean::first_piola(const Gradient& f) const {
  return mu * f + slope(area_of(f)) * cofactors_of_sheet(f);
}

// In the plane J is a determinant. Out of it the normal turns: with a change z of the columns along the normal, J grows
// by z^T adj(F^T F) z / (2 J).
DeformationHessian<2> MembraneNeoHookean::hessian(const Gradient& f) const {
  const double area = area_of(f), p = slope(area);
  const Gradient cofactors = cofactors_of_sheet(f);
  const Eigen::Matrix<double, 6, 1> g = cofactors.reshaped();
  DeformationHessian<2> h = mu * DeformationHessian<2>::Identity() + (lambda + mu) * g * g.transpose();
  const Eigen::Vector3d n = normal_of(f);
  const Eigen::Matrix3d turn = cross_product_matrix(n);
  h.block<3, 3>(0, 3) -= p * turn;
  h.block<3, 3>(3, 0) += p * turn;
  if (!(area > 0)) return h;
  Eigen::Matrix2d adjugate;
  adjugate << f.col(1).squaredNorm(), -f.col(0).dot(f.col(1)), -f.col(0).dot(f.col(1)), f.col(0).squaredNorm();
  const Eigen::Matrix3d out = p / area * n * n.transpose();
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) h.block<3, 3>(3 * a, 3 * b) += adjugate(a, b) * out;
  return h;
}

// With F = U S V^T and n the third column of U: turning in the plane and shearing have the eigenvalues mu + p and
// mu - p, tilting an axis out of the plane mu + p s_other / s_own; the two scalings are those of a 2 x 2 matrix.
DeformationHessian<2> MembraneNeoHookean::positive_hessian(const Gradient& f) const {
  const Eigen::JacobiSVD<Gradient> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& u = svd.matrixU();
  const Eigen::Matrix2d& v = svd.matrixV();
  const Eigen::Vector2d s = svd.singularValues();
  const double p = slope(s[0] * s[1]);
  DeformationHessian<2> h = DeformationHessian<2>::Zero();
  const auto add = [&](double eigenvalue, const Gradient& mode) {
    if (!(eigenvalue > 0)) return;
    const Eigen::Matrix<double, 6, 1> d = mode.reshaped();
    h += eigenvalue * d * d.transpose();
  };
  const Gradient ij = std::sqrt(0.5) * u.col(0) * v.col(1).transpose(),
                 ji = std::sqrt(0.5) * u.col(1) * v.col(0).transpose();
  add(mu + p, ij - ji);
  add(mu - p, ij + ji);
  for (int i = 0; i < 2; ++i)
    if (s[i] > 0) add(mu + p * s[1 - i] / s[i], u.col(2) * v.col(i).transpose());
  Eigen::Matrix2d scaling;
  const double both = p + (lambda + mu) * s[0] * s[1];
  scaling << mu + (lambda + mu) * s[1] * s[1], both, both, mu + (lambda + mu) * s[0] * s[0];
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(scaling);
  for (int k = 0; k < 2; ++k)
    add(eigen.eigenvalues()[k], u.leftCols<2>() * eigen.eigenvectors().col(k).asDiagonal() * v.transpose());
  return h;
}

// J grows with the distance of the vertex from the line through the others: straight away from it by c, and across the
// sheet the distance has the curvature |c|^2 / J.
VertexDerivatives MembraneNeoHookean::by_vertex(const Gradient& f, const Eigen::Vector2d& b) const {
  const Eigen::Vector3d across = f.col(0).cross(f.col(1));
  const double area = across.norm(), p = slope(area), stiff = mu * b.squaredNorm();
  const Eigen::Vector3d n = area > 0 ? Eigen::Vector3d(across / area) : normal_of(f);
  const Eigen::Vector3d c = b[0] * f.col(1).cross(n) + b[1] * n.cross(f.col(0));
  VertexDerivatives own{mu * f * b + p * c, stiff * Eigen::Matrix3d::Identity() + (lambda + mu) * c * c.transpose()};
  if (area > 0) own.hessian += std::max(p * c.squaredNorm() / area, -stiff) * n * n.transpose();
  return own;
}

}  // namespace selvage
