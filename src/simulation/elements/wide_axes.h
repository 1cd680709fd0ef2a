#pragma once

#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"

#include <limits>

/// StretchAxes and SymmetricAxes of elasticity/axes.h for several matrices side by side, by the same rotations. A lane
/// that is done waits for the others, and stays as it is: what comes out does not depend on how many there are.
namespace selvage {
inline namespace SELVAGE_ISA {

using Wide3 = LaneVec3<WideDouble>;

SELVAGE_INLINE WideDouble wide_number(double x) {
  return WideDouble::broadcast(x);
}
SELVAGE_INLINE Wide3 select_less(const WideDouble& a, const WideDouble& b, const Wide3& x, const Wide3& y) {
  return {{select_less(a, b, x[0], y[0]), select_less(a, b, x[1], y[1]), select_less(a, b, x[2], y[2])}};
}

inline constexpr int kMaxWideSweeps = 12;
inline constexpr double kWideRounding = 8 * std::numeric_limits<double>::epsilon();

/// Makes [[a, c], [c, b]] diagonal.
struct WideRotation {
  WideDouble cosine, sine;
  WideDouble tangent;

  /// None in lanes where `least` is not below `size`.
  SELVAGE_INLINE WideRotation(const WideDouble& a, const WideDouble& b, const WideDouble& c, const WideDouble& least,
                              const WideDouble& size) {
    const WideDouble zero = wide_number(0), one = wide_number(1);
    const WideDouble twice = (b - a) / (c + c);
    const WideDouble above = one / (abs(twice) + sqrt(one + twice * twice));
    tangent = select_less(least, size, select_less(twice, zero, zero - above, above), zero);
    cosine = one / sqrt(one + tangent * tangent);
    sine = tangent * cosine;
  }

  SELVAGE_INLINE void turn(Wide3& p, Wide3& q) const {
    const Wide3 was = p;
    p = cosine * was - sine * q;
    q = sine * was + cosine * q;
  }
};

/// F = U diag(stretches) V^T.
struct WideStretchAxes {
  Wide3 u[3], v[3];
  WideDouble stretches[3];

  SELVAGE_INLINE explicit WideStretchAxes(const Wide3 (&f)[3]) {
    const WideDouble zero = wide_number(0), one = wide_number(1);
    Wide3 b[3] = {f[0], f[1], f[2]};
    v[0] = {{one, zero, zero}};
    v[1] = {{zero, one, zero}};
    v[2] = {{zero, zero, one}};
    for (int sweep = 0; sweep < kMaxWideSweeps; ++sweep) {
      bool turns = turn_apart(b[0], b[1], v[0], v[1]);
      turns |= turn_apart(b[0], b[2], v[0], v[2]);
      turns |= turn_apart(b[1], b[2], v[1], v[2]);
      if (!turns) break;
    }
    put_longer_first(b[0], b[1], v[0], v[1]);
    put_longer_first(b[0], b[2], v[0], v[2]);
    put_longer_first(b[1], b[2], v[1], v[2]);
    u[0] = unit_or(b[0], {{one, zero, zero}});
    u[1] = unit_or(b[1] - dot(u[0], b[1]) * u[0], orthogonal_to(u[0]));
    u[2] = cross(u[0], u[1]);
    stretches[0] = dot(u[0], b[0]);
    stretches[1] = dot(u[1], b[1]);
    stretches[2] = dot(u[2], b[2]);
  }

 private:
  SELVAGE_INLINE static bool turn_apart(Wide3& bp, Wide3& bq, Wide3& vp, Wide3& vq) {
    const WideDouble pp = dot(bp, bp), qq = dot(bq, bq), pq = dot(bp, bq);
    const WideDouble size = pq * pq, least = wide_number(kWideRounding * kWideRounding) * pp * qq;
    if (!any_less(least, size)) return false;
    const WideRotation rotation(pp, qq, pq, least, size);
    rotation.turn(bp, bq);
    rotation.turn(vp, vq);
    return true;
  }
  /// A sign keeps a rotation one.
  SELVAGE_INLINE static void put_longer_first(Wide3& bp, Wide3& bq, Wide3& vp, Wide3& vq) {
    const WideDouble pp = dot(bp, bp), qq = dot(bq, bq);
    const Wide3 zero = {{wide_number(0), wide_number(0), wide_number(0)}}, b = bp, v = vp;
    bp = select_less(pp, qq, bq, b);
    bq = select_less(pp, qq, zero - b, bq);
    vp = select_less(pp, qq, vq, v);
    vq = select_less(pp, qq, zero - v, vq);
  }
  SELVAGE_INLINE static Wide3 unit_or(const Wide3& direction, const Wide3& other) {
    const WideDouble length = sqrt(dot(direction, direction));
    return select_less(wide_number(0), length, (wide_number(1) / length) * direction, other);
  }
  SELVAGE_INLINE static Wide3 orthogonal_to(const Wide3& unit) {
    const WideDouble zero = wide_number(0);
    const Wide3 across = select_less(abs(unit[0]), wide_number(0.5), {{zero, unit[2], zero - unit[1]}},
                                     {{zero - unit[2], zero, unit[0]}});
    return (wide_number(1) / sqrt(dot(across, across))) * across;
  }
};

/// A symmetric matrix = axes diag(values) axes^T.
struct WideSymmetricAxes {
  Wide3 axes[3];
  Wide3 values;

  /// @param diagonal  00 11 22
  /// @param across    12 02 01
  SELVAGE_INLINE WideSymmetricAxes(const Wide3& diagonal, const Wide3& across) : values(diagonal) {
    const WideDouble zero = wide_number(0), one = wide_number(1);
    axes[0] = {{one, zero, zero}};
    axes[1] = {{zero, one, zero}};
    axes[2] = {{zero, zero, one}};
    Wide3 off = across;
    const WideDouble least = wide_number(kWideRounding) * max(abs_max(diagonal), abs_max(across));
    for (int sweep = 0; sweep < kMaxWideSweeps; ++sweep) {
      bool turns = turn_apart(least, values[0], values[1], off[2], off[1], off[0], axes[0], axes[1]);
      turns |= turn_apart(least, values[0], values[2], off[1], off[2], off[0], axes[0], axes[2]);
      turns |= turn_apart(least, values[1], values[2], off[0], off[2], off[1], axes[1], axes[2]);
      if (!turns) break;
    }
  }

 private:
  /// @param pr, qr  entries of the third axis with p and q
  SELVAGE_INLINE static bool turn_apart(const WideDouble& least, WideDouble& pp, WideDouble& qq, WideDouble& pq,
                                        WideDouble& pr, WideDouble& qr, Wide3& p, Wide3& q) {
    const WideDouble size = abs(pq);
    if (!any_less(least, size)) return false;
    const WideRotation rotation(pp, qq, pq, least, size);
    const WideDouble change = rotation.tangent * pq, was = pr;
    pp = pp - change;
    qq = qq + change;
    pq = select_less(least, size, wide_number(0), pq);
    pr = rotation.cosine * was - rotation.sine * qr;
    qr = rotation.sine * was + rotation.cosine * qr;
    rotation.turn(p, q);
    return true;
  }
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
