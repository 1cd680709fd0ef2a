#pragma once

#include "selvage/core/types.h"

#include <Eigen/Eigenvalues>

#include <random>

namespace selvage {

class Randoms {
 public:
  explicit Randoms(unsigned seed = 1) : engine_(seed) {}

  double unit() { return std::uniform_real_distribution<double>(-1, 1)(engine_); }
  Vec3 vector() { return {unit(), unit(), unit()}; }
  template <int Columns>
  Eigen::Matrix<double, 3, Columns> columns() {
    Eigen::Matrix<double, 3, Columns> m;
    for (int k = 0; k < Columns; ++k) m.col(k) = vector();
    return m;
  }
  Eigen::Matrix3d matrix() { return columns<3>(); }
  Eigen::Matrix3d rotation() { return Eigen::AngleAxisd(3 * unit(), vector().normalized()).toRotationMatrix(); }
  /// Of positive determinant, and far from flat.
  Eigen::Matrix3d stretch() { return rotation() * (Eigen::Matrix3d::Identity() + 0.25 * matrix()); }
  /// Edges of a tetrahedron that is not nearly flat.
  Eigen::Matrix3d edges() {
    for (;;) {
      const Eigen::Matrix3d m = matrix();
      if (m.determinant() > 0.3) return m;
    }
  }
  /// Edges of a triangle in its plane likewise.
  Eigen::Matrix2d flat_edges() {
    for (;;) {
      const Eigen::Matrix2d m = matrix().topLeftCorner<2, 2>();
      if (m.determinant() > 0.3) return m;
    }
  }

 private:
  std::mt19937 engine_;
};

/// The nearest positive semi-definite matrix, by a numeric eigensystem. A solver of any size is compiled once, and not
/// for each size.
template <typename Matrix>
Matrix without_negative_eigenvalues(const Matrix& h) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

template <typename Matrix>
double least_eigenvalue(const Matrix& h) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(h, Eigen::EigenvaluesOnly).eigenvalues()[0];
}

}  // namespace selvage
