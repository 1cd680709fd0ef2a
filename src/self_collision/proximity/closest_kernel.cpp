#include "self_collision/proximity/closest_kernel.h"

#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

using Wide3 = LaneVec3<WideDouble>;

SELVAGE_INLINE WideDouble number(double x) {
  return WideDouble::broadcast(x);
}

SELVAGE_INLINE Wide3 load_point(const double (&coordinates)[3][SegmentPairs::kSize], int lane) {
  return {{WideDouble::load(coordinates[0] + lane), WideDouble::load(coordinates[1] + lane),
           WideDouble::load(coordinates[2] + lane)}};
}

SELVAGE_INLINE Wide3 select_less(const WideDouble& x, const WideDouble& y, const Wide3& a, const Wide3& b) {
  return {{select_less(x, y, a[0], b[0]), select_less(x, y, a[1], b[1]), select_less(x, y, a[2], b[2])}};
}

struct Best {
  WideDouble place[2], squared;
  WideDouble least, most;

  SELVAGE_INLINE void take(const WideDouble& of_a, const WideDouble& of_b, const Wide3& difference) {
    const WideDouble closer = dot(difference, difference);
    place[0] = select_less(closer, squared, of_a, place[0]);
    place[1] = select_less(closer, squared, of_b, place[1]);
    squared = select_less(closer, squared, closer, squared);
  }
  SELVAGE_INLINE void note(const WideDouble& squares) {
    least = select_less(squares, least, squares, least);
    most = select_less(most, squares, squares, most);
  }
};

struct OnSegment {
  Wide3 point;
  WideDouble place;
};

/// As closest_point_on_segment().
SELVAGE_INLINE OnSegment closest_on_segment(const Wide3& p, const Wide3& a, const Wide3& b, Best& best) {
  const WideDouble zero = number(0), one = number(1), half = number(0.5);
  const Wide3 edge = b - a, from = p - a;
  best.note(dot(from, from) + dot(edge, edge));
  const WideDouble from_a = dot(edge, from), from_b = dot(edge, b - p), total = from_a + from_b;
  const WideDouble small = select_less(from_b, from_a, from_b, from_a) / total, large = one - small;
  const Wide3 middle = half * a + half * b, after_a = a + small * edge, before_b = b - small * edge;
  OnSegment result{select_less(from_a, from_b, after_a, select_less(from_b, from_a, before_b, middle)),
                   select_less(from_a, from_b, small, large)};
  const OnSegment at_end{select_less(from_a, from_b, a, b), select_less(from_a, from_b, zero, one)};
  const auto where_above_zero = [&](const WideDouble& x, const OnSegment& else_at) {
    result.point = select_less(zero, x, result.point, else_at.point);
    result.place = select_less(zero, x, result.place, else_at.place);
  };
  where_above_zero(small, at_end);
  where_above_zero(from_b, {b, one});
  where_above_zero(from_a, {a, zero});
  return result;
}

/// Inside both, where they are not parallel: see closest_points().
SELVAGE_INLINE void take_inside(const Wide3 (&a)[2], const Wide3 (&b)[2], Best& best) {
  const WideDouble zero = number(0), one = number(1);
  const Wide3 u = a[1] - a[0], v = b[1] - b[0], w = b[0] - a[0];
  const WideDouble uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const WideDouble det = uu * vv - uv * uv;
  const WideDouble s = (uw * vv - uv * vw) / det, t = (uw * uv - uu * vw) / det;
  // Where it is not inside, or nowhere, it is no closer.
  Best inside = best;
  inside.take(s, t, w + t * v - s * u);
  const auto where_less = [&](const WideDouble& x, const WideDouble& y) {
    for (int i = 0; i < 2; ++i) inside.place[i] = select_less(x, y, inside.place[i], best.place[i]);
    inside.squared = select_less(x, y, inside.squared, best.squared);
  };
  where_less(zero, det);
  where_less(zero, s);
  where_less(s, one);
  where_less(zero, t);
  where_less(t, one);
  best = inside;
}

}  // namespace

void find_closest_places(SegmentPairs& pairs) {
  for (int lane = 0; lane < SegmentPairs::kSize; lane += WideDouble::kLanes) {
    const Wide3 a[2] = {load_point(pairs.a[0], lane), load_point(pairs.a[1], lane)},
                b[2] = {load_point(pairs.b[0], lane), load_point(pairs.b[1], lane)};
    const Wide3 first = b[0] - a[0];
    const WideDouble zero = number(0), one = number(1);
    Best best{{zero, zero}, dot(first, first), number(1), number(1)};
    for (int i = 0; i < 2; ++i) {
      const OnSegment closest = closest_on_segment(a[i], b[0], b[1], best);
      best.take(i == 0 ? zero : one, closest.place, closest.point - a[i]);
    }
    for (int i = 0; i < 2; ++i) {
      const OnSegment closest = closest_on_segment(b[i], a[0], a[1], best);
      best.take(closest.place, i == 0 ? zero : one, b[i] - closest.point);
    }
    take_inside(a, b, best);
    for (int i = 0; i < 2; ++i) best.place[i].store(pairs.place[i] + lane);
    best.squared.store(pairs.squared_distance + lane);
    best.least.store(pairs.least + lane);
    best.most.store(pairs.most + lane);
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
