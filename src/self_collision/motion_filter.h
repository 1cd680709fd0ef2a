#pragma once

#include "self_collision/plane_filter.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Eight times four points that move: a vertex and the three of a face (kCount = 1), or the two ends of an edge and
/// those of another (kCount = 2). Told apart by a direction along which the first kCount lie before the others at the
/// start and at the end of the step: then they do all the time.
template <int kCount>
class MotionFilter {
 public:
  /// @param vertices  for each of the four points, the eight vertices
  MotionFilter(const std::array<float, 4>* rounded_t0, const std::array<float, 4>* rounded_t1,
               const Index (&vertices)[4][8]) {
    WideCorner start[4], end[4];
    for (int i = 0; i < 4; ++i) {
      start[i] = gather_corner(rounded_t0, vertices[i]);
      end[i] = gather_corner(rounded_t1, vertices[i]);
    }
    // From a place near all of them, where floats are finer.
    Float8 far = Float8::broadcast(0);
    for (int i = 0; i < 4; ++i) {
      start_[i] = start[i] - start[0];
      end_[i] = end[i] - start[0];
      twice_middle_[i] = {start_[i].x + end_[i].x, start_[i].y + end_[i].y, start_[i].z + end_[i].z};
      far = max(far, max(reach(start_[i]), reach(end_[i])));
    }
    // Along a direction, two positions of which each is off by a rounding, a difference and a dot product: in all less
    // than this for each unit of the sum of the direction's coordinates.
    error_ = Float8::broadcast(2.1f * kFrameRounding) + far * Float8::broadcast(0x1p-20f);
  }

  /// Lanes whose points certainly never meet.
  SELVAGE_INLINE unsigned apart() const {
    const unsigned by_axes =
        apart_on_axis(&WideCorner::x) | apart_on_axis(&WideCorner::y) | apart_on_axis(&WideCorner::z);
    if (by_axes == 0xff) return by_axes;
    return by_axes | apart_in_the_middle();
  }

 private:
  SELVAGE_INLINE static WideCorner times(const WideCorner& a, Float8 s) { return {a.x * s, a.y * s, a.z * s}; }

  /// The directions that tell the points apart as they lie in the middle of the step, wherever they do not meet then:
  /// for a vertex, the face's normal and those of its sides; for edges, what is normal to both, and in the plane of
  /// both what is normal to one; what is left for parallel ones.
  SELVAGE_INLINE unsigned apart_in_the_middle() const {
    const WideCorner(&m)[4] = twice_middle_;
    if constexpr (kCount == 1) {
      const WideCorner ab = m[2] - m[1], bc = m[3] - m[2], ca = m[1] - m[3], normal = cross(ab, bc);
      return apart_along(normal) | apart_along(cross(normal, ab)) | apart_along(cross(normal, bc)) |
             apart_along(cross(normal, ca));
    } else {
      const WideCorner u = m[1] - m[0], v = m[3] - m[2], w = m[2] - m[0], normal = cross(u, v);
      const WideCorner aside = times(w, dot(u, u)) - times(u, dot(u, w));
      return apart_along(normal) | apart_along(cross(normal, u)) | apart_along(cross(normal, v)) | apart_along(aside) |
             apart_along(u);
    }
  }

  SELVAGE_INLINE unsigned apart_along(const WideCorner& direction) const {
    Float8 start[4], end[4];
    for (int i = 0; i < 4; ++i) {
      start[i] = dot(direction, start_[i]);
      end[i] = dot(direction, end_[i]);
    }
    const Float8 bound = error_ * (magnitude(direction.x) + magnitude(direction.y) + magnitude(direction.z));
    return apart_by(start, end, bound + Float8::broadcast(1e-30f));
  }

  SELVAGE_INLINE unsigned apart_on_axis(Float8 WideCorner::*axis) const {
    Float8 start[4], end[4];
    for (int i = 0; i < 4; ++i) {
      start[i] = start_[i].*axis;
      end[i] = end_[i].*axis;
    }
    return apart_by(start, end, error_);
  }

  /// Whether the first kCount numbers are above the others at both ends, or below them, by more than the bound.
  SELVAGE_INLINE static unsigned apart_by(const Float8 (&start)[4], const Float8 (&end)[4], Float8 bound) {
    const auto gap_above = [](const Float8(&x)[4]) {
      const Float8 first = kCount == 1 ? x[0] : min(x[0], x[1]), other = kCount == 1 ? max(x[1], x[2]) : x[2];
      return first - max(other, x[3]);
    };
    const auto gap_below = [](const Float8(&x)[4]) {
      const Float8 first = kCount == 1 ? x[0] : max(x[0], x[1]), other = kCount == 1 ? min(x[1], x[2]) : x[2];
      return min(other, x[3]) - first;
    };
    return (less_equal(bound, gap_above(start)) & less_equal(bound, gap_above(end))) |
           (less_equal(bound, gap_below(start)) & less_equal(bound, gap_below(end)));
  }

  WideCorner start_[4], end_[4], twice_middle_[4];
  Float8 error_;
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
