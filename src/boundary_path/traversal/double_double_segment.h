#pragma once

#include "boundary_path/traversal/exact_segment.h"
#include "geometry/exact/double_double.h"

#include <algorithm>
#include <array>
#include <cmath>

/// Decisions of an ExactSegment in space by double-double arithmetic (Dekker 1971): nearly all but zero, and it says
/// which.
namespace selvage::double_double {

using DoubleDouble3 = std::array<DoubleDouble, 3>;

inline DoubleDouble dot(const DoubleDouble3& a, const DoubleDouble3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline DoubleDouble3 cross(const DoubleDouble3& a, const DoubleDouble3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline DoubleDouble3 minus(const Vec3& a, const Vec3& b) {
  return {difference(a[0], b[0]), difference(a[1], b[1]), difference(a[2], b[2])};
}
inline double largest(const DoubleDouble3& a) {
  return std::max({std::abs(a[0].high), std::abs(a[1].high), std::abs(a[2].high)});
}

/// Where polynomials of degree up to 7 in double-double arithmetic neither under- nor overflow.
inline bool is_moderate(double coordinate) {
  return coordinate > 0x1p-100 && coordinate < 0x1p100;
}

/// ExactSegment::side() where double-double arithmetic tells it, else 0. With bounds of the coordinates of edges and of
/// vertices relative to p, a polynomial of them here is off by less than 2^-90 of its powers of these.
inline int side(const Vec3& p, const TargetSimplex<3>& target, const std::array<Vec3, 2>& points) {
  constexpr double kCertain = 0x1p-86;
  const DoubleDouble3 a = minus(points[0], p), b = minus(points[1], p), v = minus(target.vertices[0], p);
  DoubleDouble3 direction = v;
  double powers = largest(v);
  int sign = 1;
  if (!is_moderate(largest(a)) || !is_moderate(largest(b)) || !is_moderate(powers)) return 0;
  if (target.count > 1) {
    const DoubleDouble3 e = minus(target.vertices[1], target.vertices[0]);
    if (!is_moderate(largest(e))) return 0;
    if (target.count == 2) {
      const DoubleDouble squared = dot(e, e), along = dot(v, e);
      for (int i = 0; i < 3; ++i) direction[i] = v[i] * squared - e[i] * along;
      powers *= largest(e) * largest(e);
    } else {
      const DoubleDouble3 f = minus(target.vertices[2], target.vertices[0]);
      if (!is_moderate(largest(f))) return 0;
      direction = cross(e, f);
      const double area = largest(e) * largest(f);
      const DoubleDouble height = dot(direction, v);
      if (!(std::abs(height.high) > kCertain * area * powers)) return 0;
      sign = height.high > 0 ? 1 : -1;
      powers = area;
    }
  }
  const DoubleDouble value = dot(direction, cross(a, b));
  if (!(std::abs(value.high) > kCertain * powers * largest(a) * largest(b))) return 0;
  return value.high > 0 ? sign : -sign;
}

/// The orientation of (face, s) where double-double arithmetic tells it, else 0: a polynomial of degree up to 7, of up
/// to 144 terms, off by less than 2^-89 of its powers.
inline int side_of_end(const Vec3& p, const TargetSimplex<3>& target, const FacePoints<3>& face) {
  constexpr double kCertain = 0x1p-86;
  const DoubleDouble3 e1 = minus(face[1], face[0]), e2 = minus(face[2], face[0]), from = minus(p, face[0]);
  const DoubleDouble3 v = minus(target.vertices[0], p);
  const double reach = std::max(largest(from), largest(v));
  if (!is_moderate(reach) || !is_moderate(largest(e1)) || !is_moderate(largest(e2))) return 0;
  const DoubleDouble3 normal = cross(e1, e2);
  double powers = largest(e1) * largest(e2) * reach;
  DoubleDouble value = dot(normal, from);
  if (target.count == 1) {
    value = value + dot(normal, v);
  } else {
    const DoubleDouble3 e = minus(target.vertices[1], target.vertices[0]);
    if (!is_moderate(largest(e))) return 0;
    if (target.count == 2) {
      const DoubleDouble squared = dot(e, e);
      value = value * squared + (dot(normal, v) * squared - dot(normal, e) * dot(v, e));
      powers *= largest(e) * largest(e);
    } else {
      const DoubleDouble3 f = minus(target.vertices[2], target.vertices[0]);
      if (!is_moderate(largest(f))) return 0;
      const DoubleDouble3 n = cross(e, f);
      value = value * dot(n, n) + dot(normal, n) * dot(n, v);
      powers *= largest(e) * largest(e) * largest(f) * largest(f);
    }
  }
  if (!(std::abs(value.high) > kCertain * powers)) return 0;
  return value.high > 0 ? 1 : -1;
}

inline bool is_clear(const DoubleDouble& value, double powers) {
  return std::abs(value.high) > 0x1p-38 * powers;
}

/// precise_offset() to a triangle or an edge, where double-double arithmetic is enough: a hundred times faster than
/// integers. Let E bound the coordinates of edges and V those of vertices relative to p. A polynomial of them here has
/// at most 36 terms, each off by less than 2^-97 of its powers of E and V; so one that is above 2^-38 of these powers
/// is known to 2^-53, and what is below is left to exact arithmetic.
inline bool find_offset(const Vec3& p, const TargetSimplex<3>& target, PreciseOffset<3>& result) {
  if (target.count == 1) return false;
  std::array<DoubleDouble3, 3> v;
  double extent = 0, reach = 0;
  for (int i = 0; i < target.count; ++i) {
    v[i] = minus(target.vertices[i], p);
    reach = std::max(reach, largest(v[i]));
  }
  const DoubleDouble3 e = minus(target.vertices[1], target.vertices[0]);
  extent = largest(e);
  if (target.count == 2) {
    if (!is_moderate(extent) || !is_moderate(reach)) return false;
    const DoubleDouble squared = dot(e, e), from_first = -dot(v[0], e), from_last = dot(v[1], e);
    if (!is_clear(from_first, reach * extent) || !is_clear(from_last, reach * extent)) return false;
    DoubleDouble3 numerator;
    for (int i = 0; i < 3; ++i) numerator[i] = v[0][i] * squared + e[i] * from_first;
    if (!(largest(numerator) > 0x1p-38 * reach * extent * extent)) return false;
    for (int i = 0; i < 3; ++i) result.offset[i] = quotient(numerator[i], squared);
    result.barycentric = {quotient(from_last, squared), quotient(from_first, squared), 0};
    return true;
  }
  const DoubleDouble3 f = minus(target.vertices[2], target.vertices[0]);
  extent = std::max(extent, largest(f));
  if (!is_moderate(extent) || !is_moderate(reach)) return false;
  const DoubleDouble3 n = cross(e, f);
  const DoubleDouble squared = dot(n, n), height = dot(n, v[0]);
  const double area = extent * extent;
  if (!is_clear(squared, area * area) || !is_clear(height, area * reach)) return false;
  for (int i = 0; i < 3; ++i) {
    const DoubleDouble weight = dot(cross(v[(i + 1) % 3], v[(i + 2) % 3]), n);
    if (!is_clear(weight, reach * reach * area)) return false;
    result.barycentric[i] = quotient(weight, squared);
    result.offset[i] = quotient(n[i] * height, squared);
  }
  return true;
}

}  // namespace selvage::double_double
