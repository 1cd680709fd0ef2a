#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Velocities or displacements of a body that moves rigidly: those of x are shift + linear * (x - centre).
struct RigidMotion {
  Eigen::Matrix<double, 3, 3, Eigen::DontAlign> linear = Eigen::Matrix3d::Zero();
  Vec3 centre = Vec3::Zero(), shift = Vec3::Zero();

  Vec3 operator()(const Vec3& x) const { return shift + linear * (x - centre); }
};

/// Mass, momentum and angular momentum of moving points, summed one after the other.
class MomentumSums {
 public:
  /// Rounding is that of differences from these two: points in fast flight do not turn by it.
  /// @param origin  a position near the points, as that of one [m]
  /// @param flight  a velocity near theirs
  explicit MomentumSums(const Vec3& origin = Vec3::Zero(), const Vec3& flight = Vec3::Zero())
      : origin_(origin), flight_(flight) {}

  void add(double mass, const Vec3& position, const Vec3& velocity) {
    const Vec3 arm = position - origin_, relative = velocity - flight_, weighed = mass * arm;
    mass_ += mass;
    first_ += weighed;
    momentum_ += mass * relative;
    angular_ += weighed.cross(relative);
    for (int i = 0; i < 3; ++i) {
      squares_[i] += weighed[i] * arm[i];
      products_[i] += weighed[(i + 1) % 3] * arm[(i + 2) % 3];
    }
  }
  void add(const MomentumSums& other);

  /// Of the centre of mass [m/s]; without points 0.
  Vec3 velocity() const;
  /// Angular momentum about the centre of mass [kg m^2/s]; without points 0.
  Vec3 spin() const;
  /// The turn about the centre of mass that a rigid body of these points makes with such a spin. Points in one place or
  /// on a line do not turn.
  RigidMotion turn(const Vec3& spin) const;

  /// Of the rigid body with the same momentum and spin. Without points nothing moves.
  RigidMotion motion() const;

 private:
  Vec3 origin_, flight_;
  double mass_ = 0;
  Vec3 first_ = Vec3::Zero(), momentum_ = Vec3::Zero(), angular_ = Vec3::Zero();
  Vec3 squares_ = Vec3::Zero();   ///< sum of mass * arm_i^2
  Vec3 products_ = Vec3::Zero();  ///< of mass * arm_y * arm_z, arm_z * arm_x, arm_x * arm_y
};

}  // namespace selvage
