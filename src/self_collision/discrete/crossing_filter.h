#pragma once

#include "self_collision/surface/plane_filter.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Two triangles, of which each has vertices on both sides of the other's plane, listed so that the first vertex of
/// each is alone on its side, and above the other's plane, turning the other over where it is not.
struct WideFacingPairs {
  WideVec3 a[3], b[3];
};

/// 1 where a height is positive, -1 elsewhere: products of heights may vanish, products of these do not.
struct WideSides {
  Float8 of[3];

  SELVAGE_INLINE explicit WideSides(const Float8 (&heights)[3]) {
    for (int i = 0; i < 3; ++i)
      of[i] = select_less(Float8::broadcast(0), heights[i], Float8::broadcast(1), Float8::broadcast(-1));
  }
  /// The side of the two, or of all three.
  SELVAGE_INLINE Float8 majority() const { return of[0] + of[1] + of[2]; }
};

/// x where s is positive, y elsewhere.
SELVAGE_INLINE WideVec3 select_positive(Float8 s, const WideVec3& x, const WideVec3& y) {
  const auto select = [&](Float8 p, Float8 q) { return select_less(Float8::broadcast(0), s, p, q); };
  return {{select(x[0], y[0]), select(x[1], y[1]), select(x[2], y[2])}};
}

/// Turns the vertices around so that the one which is alone on its side comes first.
SELVAGE_INLINE void bring_lone_first(WideVec3 (&triangle)[3], const WideSides& sides) {
  const Float8 zero_is_alone = sides.of[1] * sides.of[2], one_is_alone = sides.of[2] * sides.of[0];
  const WideVec3 t[3] = {triangle[0], triangle[1], triangle[2]};
  for (int i = 0; i < 3; ++i)
    triangle[i] = select_positive(zero_is_alone, t[i], select_positive(one_is_alone, t[(i + 1) % 3], t[(i + 2) % 3]));
}

SELVAGE_INLINE void swap_where_positive(Float8 s, WideVec3& x, WideVec3& y) {
  const WideVec3 was_x = x;
  x = select_positive(s, y, x);
  y = select_positive(s, was_x, y);
}

SELVAGE_INLINE WideFacingPairs face_each_other(const WideVec3 (&a)[3], const WideVec3 (&b)[3], const WideSides& of_a,
                                               const WideSides& of_b) {
  WideFacingPairs pairs{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
  bring_lone_first(pairs.a, of_a);
  bring_lone_first(pairs.b, of_b);
  swap_where_positive(of_a.majority(), pairs.b[1], pairs.b[2]);
  swap_where_positive(of_b.majority(), pairs.a[1], pairs.a[2]);
  return pairs;
}

/// Lanes in which it is certain whether two triangles cross, or have no common point.
struct CertainLanes {
  unsigned cross;
  unsigned apart;
};

/// Where no vertex of either triangle lies on the other's plane, and both have vertices on both sides: whether on the
/// line common to the planes each begins before the other ends. The same test as that of classify_contact(), in single
/// precision with a bound of all rounding.
SELVAGE_INLINE CertainLanes tell_crossing(const WideVec3 (&a)[3], const WideVec3 (&b)[3]) {
  const WideHeights of_a = heights_over(b, a), of_b = heights_over(a, b);
  unsigned certain = 0xff;
  for (int i = 0; i < 3; ++i)
    certain &= less_equal(of_a.bound, abs(of_a.values[i])) & less_equal(of_b.bound, abs(of_b.values[i]));
  const WideSides sides_of_a(of_a.values), sides_of_b(of_b.values);
  const Float8 one = Float8::broadcast(1);
  certain &= less_equal(abs(sides_of_a.majority()), one) & less_equal(abs(sides_of_b.majority()), one);
  const WideFacingPairs pairs = face_each_other(a, b, sides_of_a, sides_of_b);
  const WideVec3 origin = pairs.a[0];
  const WideVec3 u[2] = {pairs.a[1] - origin, pairs.a[2] - origin};
  const WideVec3 w = pairs.b[0] - origin, v[2] = {pairs.b[1] - origin, pairs.b[2] - origin};
  const Float8 far = max(max(max(abs_max(u[0]), abs_max(u[1])), max(abs_max(v[0]), abs_max(v[1]))), abs_max(w));
  // As in heights_over(), with no edge shorter than the others.
  const Float8 bound = difference_error(far) * far * far * Float8::broadcast(20) + Float8::broadcast(1e-30f);
  const Float8 before = dot(cross(u[0], w), v[0]), after = dot(cross(u[1], w), v[1]);
  return {certain & less_equal(before, negate(bound)) & less_equal(bound, after),
          certain & (less_equal(bound, before) | less_equal(after, negate(bound)))};
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
