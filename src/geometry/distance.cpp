#include "selvage/geometry/distance.h"

#include <algorithm>
#include <limits>

#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/triangle_triangle.h"

namespace selvage {

ClosestSegmentPoints closest_points(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  ClosestSegmentPoints best{{0, 0}, b[0] - a[0]};
  const auto take = [&best](double place_a, double place_b, const Vec3& difference) {
    if (difference.squaredNorm() < best.difference.squaredNorm()) best = {{place_a, place_b}, difference};
  };
  for (int i = 0; i < 2; ++i) {
    const auto closest = closest_point_on_segment<3>(a[i], b[0], b[1]);
    take(i, closest.barycentric[1], closest.point - a[i]);
  }
  for (int i = 0; i < 2; ++i) {
    const auto closest = closest_point_on_segment<3>(b[i], a[0], a[1]);
    take(closest.barycentric[1], i, b[i] - closest.point);
  }
  // Inside both, where they are not parallel: the one place where the distance of their lines is smallest.
  const Vec3 u = a[1] - a[0], v = b[1] - b[0], w = b[0] - a[0];
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  if (!(det > 0)) return best;
  const double s = (uw * vv - uv * vw) / det, t = (uw * uv - uu * vw) / det;
  if (s > 0 && s < 1 && t > 0 && t < 1) take(s, t, w + t * v - s * u);
  return best;
}

Vec3 closest_difference(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  return closest_points(a, b).difference;
}

bool is_nearer(double squared_distance, double bound) {
  return squared_distance < bound * bound;
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
