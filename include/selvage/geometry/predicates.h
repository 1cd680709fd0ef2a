#pragma once

#include <array>
#include <cmath>

#include "selvage/core/types.h"

namespace selvage {

/// Sign of the area of the triangle (a, b, c): 1 counter-clockwise, -1 clockwise, 0 exactly collinear.
/// Exact for all finite doubles, including denormals and magnitudes whose products overflow or underflow.
int orient2d(const Vec2& a, const Vec2& b, const Vec2& c);

/// Sign of det(b - a, c - a, d - a): 1 for a positive tetrahedron (a, b, c, d), -1 for an inverted one, 0 exactly flat.
/// Exact for all finite doubles, including denormals and magnitudes whose products overflow or underflow.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same for any dimension: sign of the signed volume of a simplex.
inline int orientation(const std::array<Vec2, 3>& simplex) {
  return orient2d(simplex[0], simplex[1], simplex[2]);
}
inline int orientation(const std::array<Vec3, 4>& simplex) {
  return orient3d(simplex[0], simplex[1], simplex[2], simplex[3]);
}

/// Where a point lies in a simplex, decided exactly.
struct Containment {
  bool inside = false;     ///< in the closed simplex
  unsigned zero_mask = 0;  ///< bit i: the i-th barycentric coordinate is exactly 0, the point is on face i; 0 outside
};

/// Whether p lies in the closed simplex, and on which of its faces. An inverted simplex is the same set as its mirror
/// image; an exactly flat simplex contains nothing. Exact for all finite doubles.
template <int D>
Containment locate_in_simplex(const std::array<Vec<D>, D + 1>& simplex, const Vec<D>& p);

extern template Containment locate_in_simplex<2>(const std::array<Vec2, 3>&, const Vec2&);
extern template Containment locate_in_simplex<3>(const std::array<Vec3, 4>&, const Vec3&);

// What follows is the fast path, here so that it inlines into loops; the exact stages are out of line.
namespace detail {

int orient2d_exact(const Vec2& a, const Vec2& b, const Vec2& c);
int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// Bounds of the rounding error, relative to the sum of the absolute values of all terms: (3 + 16u)u and (7 + 56u)u for
// u = 2^-53 (Shewchuk 1997, orient2d and orient3d A), rounded up. What underflow adds is below 2^-1072 in the plane,
// and below 2^-1072 (1 + the sum of the factors that multiply a product) in space; a normal number in its place is
// cheaper.
inline constexpr double kRelativeError2d = 0x1p-51;
inline constexpr double kRelativeError3d = 0x1p-50;
inline constexpr double kUnderflowError = 0x1p-1000;

/// Sign of a computed value whose error is at most `error`; 0: not known. False comparisons with infinities and NaN
/// make every overflow "not known": the bound overflows whenever the value does.
inline int certain_sign(double value, double error) {
  if (value > error) return 1;
  if (-value > error) return -1;
  return 0;
}

/// Sign of det(u, v) for rounded differences u and v of exact points; 0: not known.
inline int filter_sign_of_det(const Vec2& u, const Vec2& v) {
  const double left = u[0] * v[1], right = u[1] * v[0];
  return certain_sign(left - right, kRelativeError2d * (std::abs(left) + std::abs(right)) + kUnderflowError);
}

/// A cross product of rounded differences with the sums of the absolute values of its terms.
struct BoundedCross {
  double value[3];
  double bound[3];
};

inline BoundedCross cross_with_bound(const Vec3& v, const Vec3& w) {
  const double yz = v[1] * w[2], zy = v[2] * w[1];
  const double zx = v[2] * w[0], xz = v[0] * w[2];
  const double xy = v[0] * w[1], yx = v[1] * w[0];
  return {{yz - zy, zx - xz, xy - yx},
          {std::abs(yz) + std::abs(zy), std::abs(zx) + std::abs(xz), std::abs(xy) + std::abs(yx)}};
}

/// Sign of dot(u, cross) = det(u, v, w); 0: not known.
inline int filter_sign_of_det(const Vec3& u, const BoundedCross& cross) {
  const double x = std::abs(u[0]), y = std::abs(u[1]), z = std::abs(u[2]);
  const double value = u[0] * cross.value[0] + u[1] * cross.value[1] + u[2] * cross.value[2];
  const double bound = x * cross.bound[0] + y * cross.bound[1] + z * cross.bound[2];
  return certain_sign(value, kRelativeError3d * bound + kUnderflowError * (1 + x + y + z));
}

}  // namespace detail

inline int orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  const int sign = detail::filter_sign_of_det(b - a, c - a);
  return sign != 0 ? sign : detail::orient2d_exact(a, b, c);
}

inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const int sign = detail::filter_sign_of_det(u, detail::cross_with_bound(v, w));
  return sign != 0 ? sign : detail::orient3d_exact(a, b, c, d);
}

}  // namespace selvage
