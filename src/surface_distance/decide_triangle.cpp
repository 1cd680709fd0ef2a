#include "geometry/flat_contact.h"
#include "selvage/geometry/predicates.h"
#include "surface_distance/distance_kernel.h"

namespace selvage {

namespace {

std::array<Vec3, 3> corners_of(const DistanceInput& input, Index triangle) {
  const auto& [a, b, c] = input.triangles[triangle];
  return {input.positions[a], input.positions[b], input.positions[c]};
}

/// How many times the triangle, seen from above, turns around the perturbed point: 1 counter-clockwise, -1 clockwise, 0
/// elsewhere. Counts the edges that a ray towards +x crosses upward, less those that it crosses downward.
int planar_winding_number(const std::array<Vec3, 3>& corners, const Vec3& point) {
  const auto plan = [](const Vec3& x) { return Vec2(x[0], x[1]); };
  int winding = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &tail = corners[i], &head = corners[(i + 1) % 3];
    const bool is_tail_above = tail[1] > point[1], is_head_above = head[1] > point[1];
    if (is_tail_above == is_head_above) continue;
    const int side = orient2d(plan(tail), plan(head), plan(point));
    if (is_head_above && side > 0) ++winding;
    if (is_tail_above && side < 0) --winding;
  }
  return winding;
}

}  // namespace

float take_if_nearer(const DistanceInput& input, const Vec3& point, Index triangle, ClosestTriangle& nearest) {
  const auto corners = corners_of(input, triangle);
  const ClosestPoint<3, 3> closest = closest_point_on_triangle(point, corners[0], corners[1], corners[2]);
  const double best = nearest.closest.squared_distance;
  if (closest.squared_distance < best || (closest.squared_distance == best && triangle < nearest.triangle))
    nearest = {triangle, closest};
  return round_up(nearest.closest.squared_distance);
}

bool count_crossing(const DistanceInput& input, const Vec3& point, Index triangle, SurfaceSide& side) {
  const auto corners = corners_of(input, triangle);
  const int height = orient3d(corners[0], corners[1], corners[2], point);
  if (height == 0 && triangle_contains(corners, point)) {
    side = {0, true};
    return false;
  }
  // The triangle is above the point where the point lies below its plane: on the side of the normal when that points
  // down.
  const int winding = planar_winding_number(corners, point);
  if (winding != 0 && height == -winding) side.winding_number += winding;
  return true;
}

}  // namespace selvage
