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
  mass_ += other.mass_;
  first_ += other.first_;
  second_ += other.second_;
  momentum_ += other.momentum_;
  angular_ += other.angular_;
}

RigidMotion MomentumSums::motion() const {
  if (!(mass_ > 0)) return {};
  const Vec3 centre = first_ / mass_;
  RigidMotion motion{.centre = origin_ + centre, .shift = flight_ + momentum_ / mass_};
  const Eigen::Matrix3d spread = second_ - mass_ * centre * centre.transpose();
  const Eigen::Matrix3d inertia = spread.trace() * Eigen::Matrix3d::Identity() - spread;
  // Points nearly on a line do not say how fast they turn about it.
  constexpr double kMinRoundness = 1e-6;
  const double mean = inertia.trace() / 3;
  if (!(inertia.determinant() > kMinRoundness * mean * mean * mean)) return motion;
  const Vec3 turn = inertia.ldlt().solve(Vec3(angular_ - centre.cross(momentum_)));
  motion.linear << 0, -turn[2], turn[1], turn[2], 0, -turn[0], -turn[1], turn[0], 0;
  return motion;
}

}  // namespace selvage
