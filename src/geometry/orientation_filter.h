#pragma once

#include "selvage/core/types.h"

#include <cmath>

/// The floating-point stage of `orient2d` and `orient3d` (Shewchuk 1997, stage A), and the bounds of rounding errors
/// that all filters share. What it leaves open is decided exactly.
namespace selvage {
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

}  // namespace selvage
