#include "geometry/flat_contact.h"

#include <algorithm>

#include "selvage/geometry/predicates.h"

namespace selvage {

namespace {

using Triangle = std::array<Vec3, 3>;
using PlanarTriangle = std::array<Vec2, 3>;

Vec2 without_axis(const Vec3& point, int axis) {
  return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

PlanarTriangle without_axis(const Triangle& triangle, int axis) {
  return {without_axis(triangle[0], axis), without_axis(triangle[1], axis), without_axis(triangle[2], axis)};
}

/// An axis along which the projection of (p, q, r) is a proper triangle; -1 when p, q and r are collinear.
int axis_of_proper_projection(const Vec3& p, const Vec3& q, const Vec3& r) {
  for (int axis = 0; axis < 3; ++axis)
    if (orient2d(without_axis(p, axis), without_axis(q, axis), without_axis(r, axis)) != 0) return axis;
  return -1;
}

/// On one line, along a coordinate in which it advances.
TriangleContact classify_on_line(const Triangle& a, const Triangle& b, int k) {
  const auto [a_low, a_high] = std::minmax({a[0][k], a[1][k], a[2][k]});
  const auto [b_low, b_high] = std::minmax({b[0][k], b[1][k], b[2][k]});
  if (a_high < b_low || b_high < a_low) return TriangleContact::kDisjoint;
  const bool interiors_meet = a_low < b_high && b_low < a_high;
  return interiors_meet ? TriangleContact::kCoplanarOverlap : TriangleContact::kTouching;
}

/// The separation test along the edges of a, in a plane with not all six points on one line: the sets are disjoint when
/// a line separates them strictly, their interiors when one does with points of both upon it but not all. Such a line
/// is found along an edge of a or b if there is any: the difference of the two sets is a polygon with these edges.
TriangleContact separate_along_edges(const PlanarTriangle& a, const PlanarTriangle& b) {
  TriangleContact contact = TriangleContact::kCoplanarOverlap;
  for (int i = 0; i < 3; ++i) {
    const Vec2 &p = a[i], &q = a[(i + 1) % 3];
    if (p == q) continue;
    const int own = orient2d(p, q, a[(i + 2) % 3]);
    const auto [low, high] = std::minmax({orient2d(p, q, b[0]), orient2d(p, q, b[1]), orient2d(p, q, b[2])});
    if ((own >= 0 && high < 0) || (own <= 0 && low > 0)) return TriangleContact::kDisjoint;
    if ((own >= 0 && high == 0) || (own <= 0 && low == 0)) contact = TriangleContact::kTouching;
  }
  return contact;
}

TriangleContact classify_in_plane(const PlanarTriangle& a, const PlanarTriangle& b) {
  const TriangleContact along_a = separate_along_edges(a, b);
  return along_a == TriangleContact::kDisjoint ? along_a : std::min(along_a, separate_along_edges(b, a));
}

/// A segment (or point) and a triangle that no plane holds together, or two segments that none does.
TriangleContact classify_pierced(const Triangle& triangle, const Triangle& segment) {
  int sides[3];
  for (int i = 0; i < 3; ++i) sides[i] = orient3d(triangle[0], triangle[1], triangle[2], segment[i]);
  const auto [low, high] = std::minmax_element(sides, sides + 3);
  if (*low == *high) return TriangleContact::kDisjoint;
  const Vec3 &p = segment[low - sides], &q = segment[high - sides];
  if (*low > 0 || *high < 0) return TriangleContact::kDisjoint;
  int turns[3];
  for (int i = 0; i < 3; ++i) turns[i] = orient3d(p, q, triangle[i], triangle[(i + 1) % 3]);
  const auto [left, right] = std::minmax({turns[0], turns[1], turns[2]});
  if (left < 0 && right > 0) return TriangleContact::kDisjoint;
  const bool inside = turns[0] != 0 && turns[1] != 0 && turns[2] != 0;
  return inside && *low < 0 && *high > 0 ? TriangleContact::kCrossing : TriangleContact::kTouching;
}

}  // namespace

TriangleContact classify_flat_contact(const Triangle& a, const Triangle& b) {
  const std::array<Vec3, 6> points{a[0], a[1], a[2], b[0], b[1], b[2]};
  const Vec3& p = points[0];
  const auto q = std::find_if(points.begin(), points.end(), [&](const Vec3& x) { return x != p; });
  if (q == points.end()) return TriangleContact::kCoplanarOverlap;
  int axis = -1;
  const auto r = std::find_if(q, points.end(), [&](const Vec3& x) {
    axis = axis_of_proper_projection(p, *q, x);
    return axis >= 0;
  });
  if (r == points.end()) return classify_on_line(a, b, p[0] != (*q)[0] ? 0 : p[1] != (*q)[1] ? 1 : 2);
  const bool coplanar = std::all_of(r, points.end(), [&](const Vec3& x) { return orient3d(p, *q, *r, x) == 0; });
  if (coplanar) return classify_in_plane(without_axis(a, axis), without_axis(b, axis));
  return axis_of_proper_projection(a[0], a[1], a[2]) >= 0 ? classify_pierced(a, b) : classify_pierced(b, a);
}

bool triangle_contains(const Triangle& triangle, const Vec3& point) {
  return classify_flat_contact({point, point, point}, triangle) != TriangleContact::kDisjoint;
}

}  // namespace selvage
