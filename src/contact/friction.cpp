#include "selvage/contact/friction.h"

#include <algorithm>

namespace selvage {

Vec3 friction_correction(const Vec3& displacement, const Vec3& drift, const Vec3& normal, double normal_correction,
                         const Friction& friction, FrictionState& state) {
  const auto across = [&](const Vec3& x) { return Vec3(x - normal.dot(x) * normal); };
  const Vec3 before = across(state.tangential_sum);  // on a round surface the normal was a little different then
  state.normal_sum += normal_correction;
  state.tangential_sum = before - across(displacement);
  const double length = state.tangential_sum.norm();
  const double static_limit = friction.static_coefficient * state.normal_sum;
  const double dynamic_limit = friction.dynamic_coefficient * state.normal_sum;
  if (length > static_limit) {
    const bool stops = across(drift).norm() <= dynamic_limit;
    state.tangential_sum *= std::min((stops ? std::max(static_limit, dynamic_limit) : dynamic_limit) / length, 1.0);
  }
  return state.tangential_sum - before;
}

}  // namespace selvage
