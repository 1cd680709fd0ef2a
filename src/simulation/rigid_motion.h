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

  void add(double mass, const Vec3& position, const Vec3& velocity);
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
  Eigen::Matrix<double, 3, 3, Eigen::DontAlign> second_ = Eigen::Matrix3d::Zero();  ///< sum of mass * arm * arm^T
};

}  // namespace selvage
