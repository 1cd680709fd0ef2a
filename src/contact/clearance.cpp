#include "contact/clearance.h"

#include <algorithm>

namespace selvage {

double distance_bound(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron, double enough) {
  // From a corner, where products are small and round little.
  const Vec3 origin = tetrahedron[0];
  const Vec3 p = segment[0] - origin, q = segment[1] - origin;
  const Vec3 a = tetrahedron[1] - origin, b = tetrahedron[2] - origin, c = tetrahedron[3] - origin;
  double bound = 0;
  const auto try_direction = [&](const Vec3& direction) {
    const double first = p.dot(direction), second = q.dot(direction);
    const double x = a.dot(direction), y = b.dot(direction), z = c.dot(direction);
    const double gap = std::max(std::min(first, second) - std::max({0.0, x, y, z}),
                                std::min({0.0, x, y, z}) - std::max(first, second));
    // Whatever the direction is, rounded or not, the gap along it is one; but its length must not have underflowed.
    const double length = direction.norm();
    if (length > 0x1p-400 && gap > bound * length) bound = gap / length;
  };
  try_direction(2 * (p + q) - (a + b + c));
  if (bound >= enough) return bound;
  for (int axis = 0; axis < 3; ++axis) try_direction(Vec3::Unit(axis));
  if (bound >= enough) return bound;
  try_direction(a.cross(b));
  try_direction(b.cross(c));
  try_direction(c.cross(a));
  try_direction((b - a).cross(c - a));
  if (bound >= enough) return bound;
  for (const Vec3& edge : {a, b, c, Vec3(b - a), Vec3(c - a), Vec3(c - b)}) try_direction((q - p).cross(edge));
  return bound;
}

}  // namespace selvage
