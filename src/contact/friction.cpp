#include "selvage/contact/friction.h"

#include <algorithm>

namespace selvage {

Vec3 friction_correction(const Vec3& displacement, const Vec3& drift, const Vec3& normal, double normal_correction,
                         const Friction& friction, Grip& grip) {
  const auto across = [&](const Vec3& x) { return Vec3(x - normal.dot(x) * normal); };
  const Vec3 before = across(grip.held);  // of a round surface: where the normal was a little different
  grip.pressed += normal_correction;
  grip.held = before - across(displacement);
  const double length = grip.held.norm();
  const double still = friction.static_friction * grip.pressed, slipping = friction.dynamic_friction * grip.pressed;
  if (length > still) {
    const bool stops = across(drift).norm() <= slipping;
    grip.held *= std::min((stops ? std::max(still, slipping) : slipping) / length, 1.0);
  }
  return grip.held - before;
}

}  // namespace selvage
