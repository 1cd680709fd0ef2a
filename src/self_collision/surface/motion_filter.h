#pragma once

#include "self_collision/surface/continuous_input.h"
#include "self_collision/surface/plane_filter.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// The same point of eight pairs at one time and at a later one.
struct MovingCorner {
  WideVec3 start, end;
};
SELVAGE_INLINE MovingCorner operator-(const MovingCorner& a, const MovingCorner& b) {
  return {a.start - b.start, a.end - b.end};
}

/// Gathers eight rows into a point.
SELVAGE_INLINE MovingCorner gather_moving(const MovingVertex* rows, const Index (&vertices)[8]) {
  Float8 low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = Float8::load(rows[vertices[i]].coordinates);
    high[i] = Float8::load(rows[vertices[i + 4]].coordinates);
  }
  transpose(low[0], low[1], low[2], low[3]);
  transpose(high[0], high[1], high[2], high[3]);
  MovingCorner corner;
  for (int k = 0; k < 3; ++k) {
    corner.start[k] = Float8::join(low[k].low(), high[k].low());
    corner.end[k] = Float8::join(low[k].high(), high[k].high());
  }
  return corner;
}

/// The range of some numbers at the start and at the end of a part of the step.
struct MovingExtent {
  Float8 lower[2], upper[2];

  SELVAGE_INLINE MovingExtent() = default;
  SELVAGE_INLINE MovingExtent(Float8 start, Float8 end) : lower{start, end}, upper{start, end} {}

  SELVAGE_INLINE MovingExtent joined(const MovingExtent& other) const {
    MovingExtent all;
    for (int s = 0; s < 2; ++s) {
      all.lower[s] = min(lower[s], other.lower[s]);
      all.upper[s] = max(upper[s], other.upper[s]);
    }
    return all;
  }

  /// Lanes in which all numbers are above the others by at least the bound at both ends, or below them: then they are
  /// so all the time.
  SELVAGE_INLINE unsigned apart_from(const MovingExtent& other, Float8 bound) const {
    return (less_equal(bound, lower[0] - other.upper[0]) & less_equal(bound, lower[1] - other.upper[1])) |
           (less_equal(bound, other.lower[0] - upper[0]) & less_equal(bound, other.lower[1] - upper[1]));
  }
};

/// Eight pairs of two sets of points that move: a vertex and the three of a face, the two ends of an edge and those of
/// another, the corners of two triangles. Separated by a direction along which the first set lies before the second at
/// the start and at the end of the step, or of all parts of it: then it does all the time, by linearity.
template <int kFirst, int kSecond>
class MovingSets {
 public:
  static constexpr int kPoints = kFirst + kSecond;

  /// Sets are apart where they are farther apart than the input's distance and the largest thickness of the one and of
  /// the other together, also if each point strays by its margin along every axis.
  ///
  /// @param vertices  for each of the points, the eight vertices
  SELVAGE_INLINE MovingSets(const ContinuousInput& input, const Index (&vertices)[kPoints][8]) {
    for (int i = 0; i < kPoints; ++i) points_[i] = gather_moving(input.rounded, vertices[i]);
    // As the first one sees the others: what all have in common of their places and motions costs no bits.
    const MovingCorner origin = points_[0];
    far_ = Float8::broadcast(0);
    for (MovingCorner& point : points_) {
      point = point - origin;
      far_ = max(far_, max(abs_max(point.start), abs_max(point.end)));
    }
    // Along a direction, two positions of which each is off by a rounding, and ten more of each while times are
    // shortened and dot products taken: in all less than this for each unit of the sum of the direction's coordinates.
    error_ = Float8::broadcast(4.1f * kBoxRounding) + far_ * Float8::broadcast(0x1p-19f);
    gap_ = error_ + Float8::broadcast(2.000002f * input.margin);
    distance_ = Float8::broadcast(input.distance);
    if (input.thickness != nullptr) distance_ = distance_ + thickness(input.thickness, vertices);
    has_distance_ = input.distance > 0 || input.thickness != nullptr;
  }

  /// The range of a point along an axis, and the gap between two such ranges that separates them for certain.
  SELVAGE_INLINE MovingExtent extent(int point, int axis) const {
    return {points_[point].start[axis], points_[point].end[axis]};
  }
  SELVAGE_INLINE Float8 gap() const { return gap_ + distance_; }

  /// Lanes whose sets certainly never meet.
  SELVAGE_INLINE unsigned apart() const { return apart_in_part(points_); }

  /// Lanes whose sets certainly meet, of a vertex and a face or two edges.
  SELVAGE_INLINE unsigned meet() const { return meet_in_part(points_); }

  /// Leaves a part of the time: from one fraction of it to another.
  SELVAGE_INLINE void shorten(Float8 from, Float8 to) {
    for (MovingCorner& point : points_) {
      const WideVec3 way = point.end - point.start;
      point = {point.start + from * way, point.start + to * way};
    }
  }

 private:
  using Points = MovingCorner[kPoints];

  /// The sum of both sets' thickness, rounded up.
  SELVAGE_INLINE static Float8 thickness(const float* of, const Index (&vertices)[kPoints][8]) {
    float sums[8];
    for (int lane = 0; lane < 8; ++lane) {
      float first = 0, second = 0;
      for (int i = 0; i < kPoints; ++i) {
        float& largest = i < kFirst ? first : second;
        const float own = of[vertices[i][lane]];
        largest = own > largest ? own : largest;
      }
      sums[lane] = (first + second) * 1.000001f;
    }
    return Float8::load(sums);
  }

  SELVAGE_INLINE unsigned apart_in_part(const Points& points) const {
    unsigned apart = 0;
    for (int axis = 0; axis < 3; ++axis) apart |= apart_by([&](const WideVec3& x) { return x[axis]; }, points, gap());
    return apart == 0xff ? apart : apart | apart_in_the_middle(points);
  }

  /// Lanes whose sets certainly meet: the four points change their orientation, so that some moment brings them into
  /// one plane, while their projections along one direction cross properly all the time.
  SELVAGE_INLINE unsigned meet_in_part(const Points& points) const {
    // A coordinate of a difference of two points is off by less than error_, and no larger than this.
    const Float8 largest = far_ + far_;
    const Float8 volume_bound = largest * largest * error_ * Float8::broadcast(32) + Float8::broadcast(1e-30f);
    const auto volume = [&](WideVec3 MovingCorner::*time) {
      const WideVec3 &a = points[0].*time, &b = points[1].*time, &c = points[2].*time, &d = points[3].*time;
      return dot(b - a, cross(c - a, d - a));
    };
    const Float8 before = volume(&MovingCorner::start), after = volume(&MovingCorner::end);
    const unsigned turning = (less_equal(volume_bound, before) & less_equal(volume_bound, negate(after))) |
                             (less_equal(volume_bound, negate(before)) & less_equal(volume_bound, after));
    if (turning == 0) return 0;
    WideVec3 m[kPoints];
    for (int i = 0; i < kPoints; ++i) m[i] = points[i].start + points[i].end;
    const WideVec3 along = kFirst == 1 ? cross(m[2] - m[1], m[3] - m[1]) : cross(m[1] - m[0], m[3] - m[2]);
    const Float8 bound = (abs_sum(along)) * largest * error_ * Float8::broadcast(8) + Float8::broadcast(1e-30f);
    /// On which side of the line through two points another is, seen along the direction: the range of the coefficients
    /// in Bernstein form.
    const auto side = [&](int from, int to, int of) {
      const MovingCorner edge = points[to] - points[from], other = points[of] - points[from];
      const MovingCorner left{cross(along, edge.start), cross(along, edge.end)};
      const Float8 mixed = (dot(left.start, other.end) + dot(left.end, other.start)) * Float8::broadcast(0.5f);
      const Float8 first = dot(left.start, other.start), last = dot(left.end, other.end);
      return Bounds{min(min(first, last), mixed), max(max(first, last), mixed)};
    };
    if constexpr (kFirst == 1) {
      const Float8 lowest = min(min(side(1, 2, 0).lower, side(2, 3, 0).lower), side(3, 1, 0).lower);
      return turning & less_equal(bound, lowest);
    } else {
      const auto opposite = [&](const Bounds& a, const Bounds& b) {
        return (less_equal(bound, a.lower) & less_equal(bound, negate(b.upper))) |
               (less_equal(bound, b.lower) & less_equal(bound, negate(a.upper)));
      };
      return turning & opposite(side(0, 1, 2), side(0, 1, 3)) & opposite(side(2, 3, 0), side(2, 3, 1));
    }
  }

  struct Bounds {
    Float8 lower, upper;
  };

  /// Separating directions of the sets in the middle of the time. For a vertex and a face: the face's normal, and in
  /// its plane the normals of its sides. For two edges: the normal to both, in their plane the normal to each, and two
  /// more for parallel edges. These find every separation at that moment. For two triangles: only their normals.
  SELVAGE_INLINE unsigned apart_in_the_middle(const Points& points) const {
    WideVec3 m[kPoints];
    for (int i = 0; i < kPoints; ++i) m[i] = points[i].start + points[i].end;
    const auto apart = [&](const WideVec3& direction) { return apart_along(direction, points); };
    if constexpr (kFirst == 1) {
      const WideVec3 ab = m[2] - m[1], bc = m[3] - m[2], ca = m[1] - m[3], normal = cross(ab, bc);
      return apart(normal) | apart(cross(normal, ab)) | apart(cross(normal, bc)) | apart(cross(normal, ca));
    } else if constexpr (kFirst == 2) {
      const WideVec3 u = m[1] - m[0], v = m[3] - m[2], w = m[2] - m[0], normal = cross(u, v);
      const WideVec3 aside = dot(u, u) * w - dot(u, w) * u;
      return apart(normal) | apart(cross(normal, u)) | apart(cross(normal, v)) | apart(aside) | apart(u);
    } else {
      return apart(cross(m[1] - m[0], m[2] - m[0])) | apart(cross(m[4] - m[3], m[5] - m[3]));
    }
  }

  /// What strays along every axis does so by the sum of the direction's coordinates; a distance is one by its length,
  /// which is as large where its square may vanish.
  SELVAGE_INLINE unsigned apart_along(const WideVec3& direction, const Points& points) const {
    const Float8 sum = abs_sum(direction);
    Float8 bound = gap_ * sum + Float8::broadcast(1e-30f);
    if (has_distance_)
      bound = bound + distance_ * select_less(sum, Float8::broadcast(1e-15f), sum,
                                              sqrt(dot(direction, direction)) * Float8::broadcast(1.000001f));
    return apart_by([&](const WideVec3& x) { return dot(direction, x); }, points, bound);
  }

  template <typename Measure>
  SELVAGE_INLINE static unsigned apart_by(Measure&& measure, const Points& points, Float8 bound) {
    const auto extent = [&](int first, int last) {
      MovingExtent all(measure(points[first].start), measure(points[first].end));
      for (int i = first + 1; i < last; ++i) all = all.joined({measure(points[i].start), measure(points[i].end)});
      return all;
    };
    return extent(0, kFirst).apart_from(extent(kFirst, kPoints), bound);
  }

  Points points_;
  Float8 far_, error_, gap_, distance_;
  bool has_distance_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
