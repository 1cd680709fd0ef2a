#pragma once

#include "selvage/core/types.h"

#include <limits>

namespace selvage {

/// Translation and angle of a motion at a time.
struct Keyframe {
  double time = 0;                  ///< [s]
  Vec3 translation = Vec3::Zero();  ///< [m]
  double angle = 0;                 ///< [rad]
};

/// p goes to rotation * p + translation.
struct RigidTransform {
  Eigen::Matrix<double, 3, 3, Eigen::DontAlign> rotation = Eigen::Matrix3d::Identity();
  Vec3 translation = Vec3::Zero();

  Vec3 operator()(const Vec3& p) const { return rotation * p + translation; }
  Vec3 invert(const Vec3& p) const { return rotation.transpose() * (p - translation); }
};

/// Rigid motion by key-frames. Translation and angle are linear in between, and constant before the first and after the
/// last; without key-frames nothing moves. The rotation is about `axis` through `centre`, which moves with the
/// translation.
struct Motion {
  std::vector<Keyframe> keyframes{};  ///< ascending in time
  Vec3 axis = Vec3::UnitZ();          ///< of any length but 0
  Vec3 centre = Vec3::Zero();         ///< [m]

  RigidTransform at(double time) const;
  /// Whether it is elsewhere at the one time than at the other.
  bool differs(double time, double other) const;
};

/// Vertices that follow a motion, from where they are in the state that the solver is made with, and take their
/// elements along. Pins have no key-frames.
struct Handle {
  std::vector<Index> vertices;
  Motion motion{};
  double release_time = std::numeric_limits<double>::infinity();  ///< [s] from then on they are free
};

}  // namespace selvage
