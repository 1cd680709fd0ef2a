#include "elasticity/axes.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <utility>

namespace selvage {

namespace {

/// Each sweep squares what is left: six are more than rounding needs.
constexpr int kMaxSweeps = 12;
/// What counts as 0 beside 1: rounding of a product leaves as much.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
constexpr std::pair<int, int> kPairs[] = {{0, 1}, {0, 2}, {1, 2}};

struct Rotation {
  double cosine, sine;

  /// Makes [[a, c], [c, b]] diagonal.
  static Rotation of(double a, double b, double c) {
    const double twice = (b - a) / (2 * c);
    const double tangent = std::copysign(1 / (std::abs(twice) + std::sqrt(1 + twice * twice)), twice);
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    return {cosine, tangent * cosine};
  }

  void turn_columns(Eigen::Matrix3d& m, int p, int q) const {
    const Eigen::Vector3d was = m.col(p);
    m.col(p) = cosine * was - sine * m.col(q);
    m.col(q) = sine * was + cosine * m.col(q);
  }
};

/// Swaps two columns; a sign keeps a rotation one.
void swap_columns(Eigen::Matrix3d& m, int p, int q) {
  const Eigen::Vector3d was = m.col(p);
  m.col(p) = m.col(q);
  m.col(q) = -was;
}

Eigen::Vector3d unit_or(const Eigen::Vector3d& direction, const Eigen::Vector3d& other) {
  const double length = direction.norm();
  return length > 0 ? Eigen::Vector3d(direction / length) : other;
}

}  // namespace

StretchAxes::StretchAxes(const Eigen::Matrix3d& f) : u(Eigen::Matrix3d::Identity()), v(u) {
  if (!std::isfinite(f.squaredNorm())) {
    stretches.setConstant(f.sum());
    return;
  }
  Eigen::Matrix3d b = f;
  bool turns = true;
  for (int sweep = 0; turns && sweep < kMaxSweeps; ++sweep) {
    turns = false;
    for (const auto& [p, q] : kPairs) {
      const double pp = b.col(p).squaredNorm(), qq = b.col(q).squaredNorm(), pq = b.col(p).dot(b.col(q));
      if (pq * pq <= kRounding * kRounding * pp * qq) continue;
      turns = true;
      const Rotation rotation = Rotation::of(pp, qq, pq);
      rotation.turn_columns(b, p, q);
      rotation.turn_columns(v, p, q);
    }
  }
  for (const auto& [p, q] : kPairs)
    if (b.col(p).squaredNorm() < b.col(q).squaredNorm()) {
      swap_columns(b, p, q);
      swap_columns(v, p, q);
    }
  u.col(0) = unit_or(b.col(0), Eigen::Vector3d::UnitX());
  u.col(1) = unit_or(b.col(1) - u.col(0).dot(b.col(1)) * u.col(0), u.col(0).unitOrthogonal());
  u.col(2) = u.col(0).cross(u.col(1));
  for (int k = 0; k < 3; ++k) stretches[k] = u.col(k).dot(b.col(k));
}

SymmetricAxes::SymmetricAxes(const Eigen::Matrix3d& matrix) : axes(Eigen::Matrix3d::Identity()) {
  Eigen::Matrix3d m = matrix;
  const double least = kRounding * m.cwiseAbs().maxCoeff();
  bool turns = true;
  for (int sweep = 0; turns && sweep < kMaxSweeps; ++sweep) {
    turns = false;
    for (const auto& [p, q] : kPairs) {
      if (!(std::abs(m(p, q)) > least)) continue;
      turns = true;
      const Rotation rotation = Rotation::of(m(p, p), m(q, q), m(p, q));
      rotation.turn_columns(m, p, q);
      m.transposeInPlace();
      rotation.turn_columns(m, p, q);
      rotation.turn_columns(axes, p, q);
    }
  }
  values = m.diagonal();
}

}  // namespace selvage
