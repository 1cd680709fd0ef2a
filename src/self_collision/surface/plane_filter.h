#pragma once

#include "core/simd/vec3.h"
#include "self_collision/surface/box_units.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// The same corner of eight triangles, or a vector between two.
using WideVec3 = LaneVec3<Float8>;

/// Gathers eight rows (x, y, z, any) into a corner.
///
/// @param vertex  `Index vertex(int lane)`
template <typename Vertex>
SELVAGE_INLINE WideVec3 gather_corner(const std::array<float, 4>* rows, Vertex&& vertex) {
  const auto row = [&](int lane) { return Float4::load(rows[vertex(lane)].data()); };
  Float8 pairs[4];
  for (int i = 0; i < 4; ++i) pairs[i] = Float8::join(row(i), row(i + 4));
  transpose(pairs[0], pairs[1], pairs[2], pairs[3]);
  return {{pairs[0], pairs[1], pairs[2]}};
}

/// How far a difference of two positions may be off, no coordinate of it being larger than `far`: by two roundings of
/// positions, its own, and its share of what products and sums of six products of three differences round off.
SELVAGE_INLINE Float8 difference_error(Float8 far) {
  return Float8::broadcast(2 * kBoxRounding) + far * Float8::broadcast(0x1p-22f);
}

/// Heights of three points over the plane of a triangle, times the length of its normal.
struct WideHeights {
  Float8 values[3];
  Float8 bound;   ///< how far they may be off, each coordinate being off by at most kBoxRounding
  Float8 length;  ///< the normal is not longer
};

SELVAGE_INLINE WideHeights heights_over(const WideVec3 (&triangle)[3], const WideVec3 (&points)[3]) {
  const WideVec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], normal = cross(u, v);
  const WideVec3 w[3] = {points[0] - triangle[0], points[1] - triangle[0], points[2] - triangle[0]};
  const Float8 edge_reach = max(abs_max(u), abs_max(v));
  const Float8 far_reach = max(edge_reach, max(max(abs_max(w[0]), abs_max(w[1])), abs_max(w[2])));
  // By 6 (2 edge_reach far_reach + edge_reach^2) times the error of a difference.
  const Float8 error = difference_error(far_reach);
  // The true normal is at most 1.8 edge_reach long for each edge_reach of an edge: 3 covers its error as well.
  return {{dot(normal, w[0]), dot(normal, w[1]), dot(normal, w[2])},
          error * edge_reach * far_reach * Float8::broadcast(20) + Float8::broadcast(1e-30f),
          sqrt(dot(normal, normal)) * Float8::broadcast(1.00001f) + error * edge_reach * Float8::broadcast(8) +
              Float8::broadcast(1e-18f)};
}

/// Lanes in which the points all lie on one side of the plane, at least as high as the bound.
SELVAGE_INLINE unsigned lie_beyond(const WideHeights& heights, Float8 bound) {
  const Float8 lowest = min(min(heights.values[0], heights.values[1]), heights.values[2]);
  const Float8 highest = max(max(heights.values[0], heights.values[1]), heights.values[2]);
  return less_equal(bound, lowest) | less_equal(highest, negate(bound));
}

/// Lanes in which the points all lie strictly on one side of the triangle's plane, and farther from it than
/// `distance`.
SELVAGE_INLINE unsigned beside_plane(const WideVec3 (&triangle)[3], const WideVec3 (&points)[3], Float8 distance) {
  const WideHeights heights = heights_over(triangle, points);
  return lie_beyond(heights, heights.bound + distance * heights.length);
}
SELVAGE_INLINE unsigned beside_plane(const WideVec3 (&triangle)[3], const WideVec3 (&points)[3]) {
  const WideHeights heights = heights_over(triangle, points);
  return lie_beyond(heights, heights.bound);
}

/// How far the height of a point along a direction may be off; the point is relative to another, and no coordinate of
/// it is larger than `far`.
SELVAGE_INLINE Float8 rounding_along(const WideVec3& direction, Float8 far) {
  // Two positions off by their rounding, and below 16 roundings of differences and dot products.
  const Float8 error = Float8::broadcast(2 * kBoxRounding) + far * Float8::broadcast(0x1p-20f);
  const Float8 length = abs_sum(direction);
  return error * length + Float8::broadcast(1e-30f);
}

/// Lanes in which the triangles lie apart along a direction by more than `distance` times its length; a and b are
/// relative to a place near both, none of whose coordinates is off by more than `error`.
SELVAGE_INLINE unsigned apart_along(const WideVec3& direction, const WideVec3 (&a)[3], const WideVec3 (&b)[3],
                                    Float8 error, Float8 distance) {
  const Float8 p[3] = {dot(direction, a[0]), dot(direction, a[1]), dot(direction, a[2])};
  const Float8 q[3] = {dot(direction, b[0]), dot(direction, b[1]), dot(direction, b[2])};
  const Float8 length = abs_sum(direction);
  const Float8 bound = (error + distance) * length + Float8::broadcast(1e-30f);
  const Float8 above = min(min(p[0], p[1]), p[2]) - max(max(q[0], q[1]), q[2]);
  const Float8 below = min(min(q[0], q[1]), q[2]) - max(max(p[0], p[1]), p[2]);
  return less_equal(bound, above) | less_equal(bound, below);
}

SELVAGE_INLINE WideVec3 unit(const WideVec3& a) {
  return (Float8::broadcast(1) / sqrt(dot(a, a))) * a;
}

/// Lanes in which two triangles that share one vertex certainly have no other point in common: a plane through it lies
/// strictly between the other vertices of the one and those of the other. All are relative to the vertex.
SELVAGE_INLINE unsigned apart_but_for_vertex(const WideVec3 (&a)[2], const WideVec3 (&b)[2]) {
  // Whatever the direction is, only what lies along it is rounded.
  const WideVec3 direction = unit(a[0]) + unit(a[1]) - unit(b[0]) - unit(b[1]);
  const Float8 far = max(max(abs_max(a[0]), abs_max(a[1])), max(abs_max(b[0]), abs_max(b[1])));
  const Float8 bound = rounding_along(direction, far);
  const Float8 above = min(dot(direction, a[0]), dot(direction, a[1]));
  const Float8 below = max(dot(direction, b[0]), dot(direction, b[1]));
  return less_equal(bound, above) & less_equal(below, negate(bound));
}

/// The same for two triangles that share an edge, from the vertex to another, and the third vertex of each: a plane
/// through the edge lies strictly between these.
SELVAGE_INLINE unsigned apart_but_for_edge(const WideVec3& edge, const WideVec3& a, const WideVec3& b) {
  const auto across = [&](const WideVec3& x) { return unit(dot(edge, edge) * x - dot(edge, x) * edge); };
  const WideVec3 direction = across(a) - across(b);
  const Float8 far = max(abs_max(edge), max(abs_max(a), abs_max(b)));
  const Float8 bound = rounding_along(direction, far);
  // The direction is not quite normal to the edge. The one that is differs by this share of the edge's height from it,
  // at a point as far away as the farthest: three times far is more than that, and abs_max(edge) less than the length
  // of the edge.
  const Float8 tilt = (abs(dot(direction, edge)) + bound) * far * Float8::broadcast(3) /
                      (abs_max(edge) - Float8::broadcast(2 * kBoxRounding));
  const unsigned long_enough = less_equal(Float8::broadcast(4 * kBoxRounding), abs_max(edge));
  return long_enough & less_equal(bound + tilt, dot(direction, a)) &
         less_equal(dot(direction, b), negate(bound + tilt));
}

/// Lanes in which the triangles certainly lie farther apart than `distance`. Separating directions are those normal to
/// an edge of each triangle, and those in the plane of one triangle that are normal to an edge of it. Together with the
/// planes' normals these separate any two triangles that do not meet, in one plane or not.
SELVAGE_INLINE unsigned apart_by_edges(const WideVec3 (&first)[3], const WideVec3 (&second)[3], Float8 distance) {
  const WideVec3 origin = first[0];
  const WideVec3 a[3] = {first[0] - origin, first[1] - origin, first[2] - origin};
  const WideVec3 b[3] = {second[0] - origin, second[1] - origin, second[2] - origin};
  Float8 far = Float8::broadcast(0);
  for (int i = 0; i < 3; ++i) far = max(far, max(abs_max(a[i]), abs_max(b[i])));
  // Two positions off by their rounding, and below 16 roundings of differences and dot products.
  const Float8 error = Float8::broadcast(2 * kBoxRounding) + far * Float8::broadcast(0x1p-20f);
  const WideVec3 edges_a[3] = {a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const WideVec3 edges_b[3] = {b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const WideVec3 normal_a = cross(edges_a[0], edges_a[1]), normal_b = cross(edges_b[0], edges_b[1]);
  unsigned apart = 0;
  for (int i = 0; i < 3; ++i)
    apart |= apart_along(cross(normal_a, edges_a[i]), a, b, error, distance) |
             apart_along(cross(normal_b, edges_b[i]), a, b, error, distance);
  if (apart == 0xff) return apart;
  for (const WideVec3& u : edges_a)
    for (const WideVec3& v : edges_b) apart |= apart_along(cross(u, v), a, b, error, distance);
  return apart;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
