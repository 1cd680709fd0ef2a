#pragma once

#include <array>

#include "selvage/core/types.h"

namespace selvage {

/// Two points, one of each of two segments, that are closest to each other.
struct ClosestSegmentPoints {
  std::array<double, 2> place{};  ///< of each point along its segment: 0 at the first end, 1 at the second
  Vec3 difference;                ///< from the point of the first segment to that of the second
};

/// Closest points of two segments, up to rounding. A segment may be a point. Of parallel segments with many such pairs
/// of points, one that has an end in it.
ClosestSegmentPoints closest_points(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// The difference of the closest points of two segments: the same as of `closest_points`.
Vec3 closest_difference(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// Squared distance between two segments, up to rounding. A segment may be a point.
double squared_distance(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b);

/// Squared distance between two triangles, up to rounding; exactly 0 where they meet, and only there. Triangles may be
/// degenerate.
double squared_distance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether a distance is below a bound, both not negative.
bool is_nearer(double squared_distance, double bound);

}  // namespace selvage
