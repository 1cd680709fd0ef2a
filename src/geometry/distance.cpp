#include "selvage/geometry/distance.h"

#include <algorithm>
#include <limits>

#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/triangle_triangle.h"

namespace selvage {

Vec3 closest_difference(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  Vec3 best = b[0] - a[0];
  const auto take = [&best](const Vec3& difference) {
    if (difference.squaredNorm() < best.squaredNorm()) best = difference;
  };
  for (const Vec3& p : a) take(closest_point_on_segment<3>(p, b[0], b[1]).point - p);
  for (const Vec3& p : b) take(p - closest_point_on_segment<3>(p, a[0], a[1]).point);
  // Inside both, where they are not parallel: the one place where the distance of their lines is smallest.
  const Vec3 u = a[1] - a[0], v = b[1] - b[0], w = b[0] - a[0];
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  if (!(det > 0)) return best;
  const double s = (uw * vv - uv * vw) / det, t = (uw * uv - uu * vw) / det;
  if (s > 0 && s < 1 && t > 0 && t < 1) take(w + t * v - s * u);
  return best;
}

double squared_distance(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  return closest_difference(a, b).squaredNorm();
}

double squared_distance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  if (triangles_meet(a, b)) return 0;
  double best = std::numeric_limits<double>::infinity();
  for (const Vec3& p : a) best = std::min(best, closest_point_on_triangle(p, b[0], b[1], b[2]).squared_distance);
  for (const Vec3& p : b) best = std::min(best, closest_point_on_triangle(p, a[0], a[1], a[2]).squared_distance);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      best = std::min(best, squared_distance(std::array{a[i], a[(i + 1) % 3]}, std::array{b[k], b[(k + 1) % 3]}));
  // Below the range of doubles it may have vanished.
  return best > 0 ? best : std::numeric_limits<double>::denorm_min();
}

}  // namespace selvage
