#pragma once

#include <array>

#include "selvage/core/types.h"

namespace selvage {

/// From a point of the one segment that is closest to the other to the point of that which is closest to it, up to
/// rounding. A segment may be a point.
Vec3 closest_difference(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// Squared distance between two segments, up to rounding. A segment may be a point.
double squared_distance(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// Squared distance between two triangles, up to rounding; exactly 0 where they meet, and only there. Triangles may be
/// degenerate.
double squared_distance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether a distance is below a bound, both not negative.
inline bool is_nearer(double squared_distance, double bound) {
  return squared_distance < bound * bound;
}

}  // namespace selvage
