#include "simulation/rigid_motion.h"

namespace selvage {

void MomentumSums::add(const MomentumSums& other) {
  const Vec3 arm = other.origin_ - origin_, relative = other.flight_ - flight_;
  mass_ += other.mass_;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    squares_[i] += other.squares_[i] + 2 * other.first_[i] * arm[i] + other.mass_ * arm[i] * arm[i];
    products_[i] +=
        other.products_[i] + other.first_[j] * arm[k] + arm[j] * other.first_[k] + other.mass_ * arm[j] * arm[k];
  }
  first_ += other.first_ + other.mass_ * arm;
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
  Eigen::Matrix3d spread = squares_.asDiagonal();
  spread(1, 0) = spread(0, 1) = products_[2];
  spread(2, 0) = spread(0, 2) = products_[1];
  spread(2, 1) = spread(1, 2) = products_[0];
  spread -= mass_ * centre * centre.transpose();
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
