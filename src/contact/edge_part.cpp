#include "contact/edge_part.h"

#include "selvage/geometry/predicates.h"

#include <algorithm>

namespace selvage {

std::optional<double> middle_of_part(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron) {
  double first = 0, last = 1;
  for (int i = 0; i < 4; ++i) {
    const Vec3 &a = tetrahedron[(i + 1) & 3], &b = tetrahedron[(i + 2) & 3], &c = tetrahedron[(i + 3) & 3];
    const Vec3 normal = (b - a).cross(c - a);
    const double inside = normal.dot(tetrahedron[i] - a) < 0 ? -1 : 1;
    const double start = inside * normal.dot(segment[0] - a), end = inside * normal.dot(segment[1] - a);
    if (start < 0 && end < 0) return {};
    if (start < 0) first = std::max(first, start / (start - end));
    if (end < 0) last = std::min(last, start / (start - end));
  }
  if (!(first <= last)) return {};
  const double middle = (first + last) / 2;
  const Vec3 point = segment[0] + middle * (segment[1] - segment[0]);
  if (!point.allFinite() || !locate_in_simplex<3>(tetrahedron, point).inside) return {};
  return middle;
}

}  // namespace selvage
