#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// The point of a simplex of N vertices that is closest to a given point, and the feature it lies on.
///
/// Computed in doubles, to a few units in the last place of the largest coordinate; within that of a smaller feature
/// either may be named. Coordinates of any magnitude. O(1).
template <int D, int N>
struct ClosestPoint {
  Vec<D> point;
  double squared_distance = 0;
  std::array<double, N> barycentric{};  ///< sums to 1, none negative; exactly 0 off the feature
  unsigned vertex_mask = 0;             ///< bit i set: vertex i spans the feature; one bit: a vertex, two: an edge, ...
};

/// Closest point of the segment (a, b). A segment of equal ends is its first vertex.
template <int D>
ClosestPoint<D, 2> closest_point_on_segment(const Vec<D>& p, const Vec<D>& a, const Vec<D>& b);

/// Closest point of the triangle (a, b, c) in space. A flat triangle is the union of its edges.
ClosestPoint<3, 3> closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

/// Closest point of the tetrahedron (a, b, c, d); p itself where p is inside (decided exactly). A flat or inverted one
/// is the same set of points in any order of its vertices.
ClosestPoint<3, 4> closest_point_on_tetrahedron(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c,
                                                const Vec3& d);

extern template ClosestPoint<2, 2> closest_point_on_segment<2>(const Vec2&, const Vec2&, const Vec2&);
extern template ClosestPoint<3, 2> closest_point_on_segment<3>(const Vec3&, const Vec3&, const Vec3&);

}  // namespace selvage
