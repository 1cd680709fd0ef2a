#include "picture/drawing/camera.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr double kEyeDistance = 4.0;  // of the scene's radius: a mild perspective

struct Spread {
  Vec3 widest, thinnest;
  bool clear;  // the spread differs enough for the axes to mean something
};

Spread principal_axes(std::span<const Vec3> points, const Vec3& centre) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) spread += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d& values = solver.eigenvalues();
  return {solver.eigenvectors().col(2), solver.eigenvectors().col(0), values[0] < 0.6 * values[1]};
}

/// One of the two signs of an axis, always the same one: the largest component is positive, z before y before x.
Vec3 choose_sign(const Vec3& axis) {
  for (int i = 2; i >= 0; --i) {
    if (std::abs(axis[i]) > 0.5) return axis[i] > 0 ? axis : Vec3(-axis);
  }
  return axis;
}

}  // namespace

void Camera::choose_axes(std::span<const Vec3> points, const View& view) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : points) centre += p / static_cast<double>(points.size());
  Vec3 up = view.up;
  Vec3 to_eye(0.45, -0.8, 0.4);
  if (view.eye) {
    to_eye = *view.eye - view.target.value_or(centre);
  } else if (view.towards && view.towards->norm() > 0) {
    to_eye = *view.towards;
  } else if (const Spread axes = principal_axes(points, centre); axes.clear) {
    const Vec3 face = choose_sign(axes.thinnest), along = choose_sign(axes.widest);
    up = face.cross(along);
    if (up[2] < -0.1 || (std::abs(up[2]) <= 0.1 && up[1] < 0)) up = -up;
    to_eye = face + 0.35 * up;
  }
  forward_ = to_eye.norm() > 0 ? Vec3(-to_eye.normalized()) : Vec3(0, 1, 0);
  if (forward_.cross(up).norm() < 1e-3 * up.norm())
    up = std::abs(up[1]) < 0.9 * up.norm() ? Vec3::UnitY() : Vec3::UnitX();
  right_ = forward_.cross(up).normalized();
  down_ = forward_.cross(right_);
}

Camera::Camera(std::span<const Vec3> points, const View& view, const Frame& frame) {
  choose_axes(points, view);
  Vec3 lower = points[0], upper = points[0];
  for (const Vec3& p : points) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  radius_ = std::max((upper - lower).norm() / 2, 1e-300);
  if (view.eye) {
    eye_ = *view.eye;
    focal_ = (frame.bottom - frame.top) / (2 * std::tan(view.angle * 3.14159265358979323846 / 360));
    centre_x_ = (frame.left + frame.right) / 2;
    centre_y_ = (frame.top + frame.bottom) / 2;
    return;
  }
  eye_ = (lower + upper) / 2 - kEyeDistance * radius_ * forward_;
  fit(points, frame);
}

void Camera::fit(std::span<const Vec3> points, const Frame& frame) {
  double left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
  for (const Vec3& p : points) {
    const Vec3 d = rotate(p - eye_);
    left = std::min(left, d[0] / d[2]);
    right = std::max(right, d[0] / d[2]);
    top = std::min(top, d[1] / d[2]);
    bottom = std::max(bottom, d[1] / d[2]);
  }
  const double width = std::max(right - left, 1e-6), height = std::max(bottom - top, 1e-6);
  focal_ = std::min((frame.right - frame.left) / width, (frame.bottom - frame.top) / height);
  centre_x_ = (frame.left + frame.right) / 2 - focal_ * (left + right) / 2;
  centre_y_ = (frame.top + frame.bottom) / 2 - focal_ * (top + bottom) / 2;
}

}  // namespace selvage
