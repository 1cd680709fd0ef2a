#include "selvage/simulation/motion.h"

#include <algorithm>

namespace selvage {

namespace {

Keyframe interpolate(const std::vector<Keyframe>& keyframes, double time) {
  if (keyframes.empty()) return {};
  const auto after = std::upper_bound(keyframes.begin(), keyframes.end(), time,
                                      [](double t, const Keyframe& keyframe) { return t < keyframe.time; });
  if (after == keyframes.begin()) return keyframes.front();
  if (after == keyframes.end()) return keyframes.back();
  const Keyframe& before = *(after - 1);
  const double share = (time - before.time) / (after->time - before.time);
  return {time, before.translation + share * (after->translation - before.translation),
          before.angle + share * (after->angle - before.angle)};
}

}  // namespace

RigidTransform Motion::at(double time) const {
  const Keyframe place = interpolate(keyframes, time);
  RigidTransform result;
  if (place.angle != 0) {
    result.rotation = Eigen::AngleAxisd(place.angle, axis.normalized()).toRotationMatrix();
    result.translation = centre - result.rotation * centre;
  }
  result.translation += place.translation;
  return result;
}

bool Motion::differs(double time, double other) const {
  const RigidTransform first = at(time), second = at(other);
  return first.rotation != second.rotation || first.translation != second.translation;
}

}  // namespace selvage
