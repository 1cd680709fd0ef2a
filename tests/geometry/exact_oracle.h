#pragma once

#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <random>

#include "selvage/core/types.h"

namespace selvage::test {

using Rational = boost::multiprecision::cpp_rational;
template <int D>
using RationalPoint = std::array<Rational, D>;

template <int D>
RationalPoint<D> to_rational(const Vec<D>& p) {
  RationalPoint<D> result;
  for (int k = 0; k < D; ++k) result[k] = Rational(p[k]);
  return result;
}

/// Determinant of the edge vectors from the first point, for integers and rationals alike.
template <class T>
T signed_volume(const std::array<std::array<T, 2>, 3>& p) {
  return (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
}
template <class T>
T signed_volume(const std::array<std::array<T, 3>, 4>& p) {
  std::array<std::array<T, 3>, 3> m;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m[i][k] = p[i + 1][k] - p[0][k];
  // Sarrus, so that the text differs from the library's expansion along a row.
  return m[0][0] * m[1][1] * m[2][2] + m[0][1] * m[1][2] * m[2][0] + m[0][2] * m[1][0] * m[2][1] -
         m[0][2] * m[1][1] * m[2][0] - m[0][1] * m[1][0] * m[2][2] - m[0][0] * m[1][2] * m[2][1];
}

template <class T>
int sign(const T& value) {
  return value > 0 ? 1 : value < 0 ? -1 : 0;
}

/// Orientation in rational arithmetic.
template <int D>
int rational_orientation(const std::array<Vec<D>, D + 1>& simplex) {
  std::array<RationalPoint<D>, D + 1> exact;
  for (int i = 0; i <= D; ++i) exact[i] = to_rational<D>(simplex[i]);
  return sign(signed_volume(exact));
}

/// The same with one denominator for all doubles, 2^1074: the numerators alone decide, which avoids the many greatest
/// common divisors of rational arithmetic. A test holds it against `rational_orientation`.
template <int D>
int fixed_point_orientation(const std::array<Vec<D>, D + 1>& simplex) {
  using boost::multiprecision::cpp_int;
  std::array<std::array<cpp_int, D>, D + 1> numerators;
  for (int i = 0; i <= D; ++i)
    for (int k = 0; k < D; ++k) {
      const auto bits = std::bit_cast<std::uint64_t>(simplex[i][k]);
      const auto biased_exponent = static_cast<unsigned>(bits >> 52 & 0x7ff);
      const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
      cpp_int& numerator = numerators[i][k];
      numerator = biased_exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
      if (biased_exponent > 1) numerator <<= biased_exponent - 1;
      if (simplex[i][k] < 0) numerator = -numerator;
    }
  return sign(signed_volume(numerators));
}

__extension__ using Int128 = __int128;

/// Points of an integer lattice of coordinates below 2^30 in magnitude: their determinants fit in 128 bits.
template <int D>
using LatticePoint = std::array<std::int64_t, D>;

template <int D>
int lattice_orientation(const std::array<LatticePoint<D>, D + 1>& simplex) {
  std::array<std::array<Int128, D>, D + 1> wide;
  for (int i = 0; i <= D; ++i)
    for (int k = 0; k < D; ++k) wide[i][k] = simplex[i][k];
  return sign(signed_volume(wide));
}

template <int D>
Vec<D> to_point(const LatticePoint<D>& lattice, double scale = 1) {
  Vec<D> result;
  for (int k = 0; k < D; ++k) result[k] = static_cast<double>(lattice[k]) * scale;
  return result;
}

/// A source of random numbers of several kinds.
class RandomSource {
 public:
  explicit RandomSource(std::uint64_t seed) : engine_(seed) {}

  std::int64_t integer(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  double uniform() { return static_cast<double>(static_cast<std::int64_t>(engine_()) >> 10) * 0x1p-53; }  ///< [-1, 1)
  double with_exponent(int low, int high) { return std::ldexp(uniform(), static_cast<int>(integer(low, high))); }
  double any_finite() {
    for (;;) {
      const double value = std::bit_cast<double>(engine_());
      if (std::isfinite(value)) return value;
    }
  }
  template <int D>
  Vec<D> point() {
    Vec<D> result;
    for (int k = 0; k < D; ++k) result[k] = uniform();
    return result;
  }
  template <int D>
  LatticePoint<D> lattice_point(std::int64_t range) {
    LatticePoint<D> result;
    for (std::int64_t& value : result) value = integer(-range, range);
    return result;
  }
  /// The value, or one of its two neighbours among the doubles.
  double nudge(double value) {
    const std::int64_t way = integer(-1, 1);
    return way == 0 ? value : std::nextafter(value, static_cast<double>(way) * HUGE_VAL);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace selvage::test
