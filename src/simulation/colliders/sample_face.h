#pragma once

#include "selvage/core/types.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>

namespace selvage {

/// Points of a triangle that lie near a box, at most `spacing` apart, each off the edges: all within the box, and a few
/// beside it. O(points + log(length / spacing)).
/// @param emit  called with each, in order
template <typename Emit>
void sample_face(const std::array<Vec3, 3>& face, const Eigen::AlignedBox3d& box, double spacing, Emit&& emit) {
  const auto length = [&](int i) { return (face[(i + 1) % 3] - face[i]).norm(); };
  const Vec3 centre = (face[0] + face[1] + face[2]) / 3;
  const int longest = std::max({0, 1, 2}, [&](int i, int k) { return length(i) < length(k); });
  if (box.exteriorDistance(centre) > length(longest)) return;
  if (length(longest) <= spacing) return emit(centre);
  const Vec3 &p = face[longest], &q = face[(longest + 1) % 3], &r = face[(longest + 2) % 3], middle = 0.5 * (p + q);
  sample_face({p, middle, r}, box, spacing, emit);
  sample_face({middle, q, r}, box, spacing, emit);
}

}  // namespace selvage
