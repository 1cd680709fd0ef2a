#include "self_collision/culling/direction_cone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage {

DirectionCone DirectionCone::of(const Vec3& direction) {
  const double length = direction.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return {Vec3::UnitZ(), std::numbers::pi};
  return {direction / length, 0};
}

void DirectionCone::merge(const DirectionCone& other) {
  if (other.is_empty()) return;
  if (is_empty()) {
    *this = other;
    return;
  }
  const double between = std::acos(std::clamp(axis.dot(other.axis), -1.0, 1.0));
  if (between + other.angle <= angle) return;
  if (between + angle <= other.angle) {
    *this = other;
    return;
  }
  const double merged = (angle + between + other.angle) / 2;
  const Vec3 across = other.axis - axis.dot(other.axis) * axis;
  const double length = across.norm();
  if (!(merged < std::numbers::pi) || !(length > 0)) {
    angle = std::numbers::pi;
    return;
  }
  // The smallest cone around both: turned from this axis towards the other.
  const double turn = merged - angle;
  axis = (std::cos(turn) * axis + std::sin(turn) / length * across).normalized();
  angle = merged;
}

}  // namespace selvage
