#include "selvage/contact/friction.h"

#include <algorithm>

namespace selvage {

Vec3 friction_correction(const Vec3& displacement, const Vec3& normal, double normal_correction,
                         const Friction& friction, Grip& grip) {
  const auto across = [&](const Vec3& x) { return Vec3(x - normal.dot(x) * normal); };
  const Vec3 before = across(grip.held);  // of a round surface: where the normal was a little different
  grip.pressed += normal_correction;
  grip.held = before - across(displacement);
  const double length = grip.held.norm();
  if (length > friction.static_friction * grip.pressed)
    grip.held *= std::min(friction.dynamic_friction * grip.pressed / length, 1.0);
  return grip.held - before;
}

}  // namespace selvage
