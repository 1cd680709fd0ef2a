#include "simulation/rigid_motion.h"

namespace selvage {

void MomentumSums::add(double mass, const Vec3& position, const Vec3& velocity) {
  const Vec3 arm = position - origin_, relative = velocity - flight_;
  mass_ += mass;
  first_ += mass * arm;
  second_ += mass * arm * arm.transpose();
  momentum_ += mass * relative;
  angular_ += mass * arm.cross(relative);
}

void MomentumSums::add(const MomentumSums& other) {
  const Vec3 arm = other.origin_ - origin_, relative = other.flight_ - flight_;
  mass_ += other.mass_;
  first_ += other.first_ + other.mass_ * arm;
  second_ += other.second_ + other.first_ * arm.transpose() + arm * other.first_.transpose() +
             other.mass_ * arm * arm.transpose();
  momentum_ += other.momentum_ + other.mass_ * relative;
  angular_ +=
      other.angular_ + arm.cross(other.momentum_) + other.first_.cross(relative) + other.mass_ * arm.cross(relative);
}

Vec3 MomentumSums::velocity() const {
  if (!(mass_ > 0)) return Vec3::Zero();
  return flight_ + momentum_ / mass_;
}

Vec3 MomentumSums::spin() const {
  if (!(mass_ > 0)) return Vec3::Zero();
  return angular_ - (first_ / mass_).cross(momentum_);
}

RigidMotion MomentumSums::turn(const Vec3& spin) const {
  if (!(mass_ > 0)) return {};
  const Vec3 centre = first_ / mass_;
  RigidMotion motion{.centre = origin_ + centre};
  const Eigen::Matrix3d spread = second_ - mass_ * centre * centre.transpose();
  const Eigen::Matrix3d inertia = spread.trace() * Eigen::Matrix3d::Identity() - spread;
  // Points nearly on a line do not say how fast they turn about it.
  constexpr double kMinRoundness = 1e-6;
  const double mean = inertia.trace() / 3;
  if (!(inertia.determinant() > kMinRoundness * mean * mean * mean)) return motion;
  const Vec3 turn = inertia.ldlt().solve(spin);
  motion.linear << 0, -turn[2], turn[1], turn[2], 0, -turn[0], -turn[1], turn[0], 0;
  return motion;
}

RigidMotion MomentumSums::motion() const {
  RigidMotion motion = turn(spin());
  motion.shift = velocity();
  return motion;
}

}  // namespace selvage
