#pragma once

#include "boundary_path/oracle/rational.h"

#include <bit>
#include <cmath>

namespace selvage::oracle {

template <int D>
using IntegerVec = std::array<Integer, D>;

/// The smallest k for which x * 2^k is an integer; a very small number for zero.
inline int fraction_bits(double x) {
  if (x == 0) return -4096;
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  return 53 - exponent - std::countr_zero(static_cast<std::uint64_t>(mantissa));
}

template <int D>
int fraction_bits(const Vec<D>& x) {
  int bits = -4096;
  for (int i = 0; i < D; ++i) bits = std::max(bits, fraction_bits(x[i]));
  return bits;
}

/// x * 2^bits, which must be an integer.
inline Integer to_integer(double x, int bits) {
  if (x == 0) return 0;
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x, &exponent), 53));
  const int shift = exponent - 53 + bits;
  if (shift >= 0) return Integer(mantissa) << shift;
  return mantissa / (std::int64_t{1} << -shift);
}

template <int D>
IntegerVec<D> to_integer(const Vec<D>& x, int bits) {
  IntegerVec<D> result;
  for (int i = 0; i < D; ++i) result[i] = to_integer(x[i], bits);
  return result;
}

/// sqrt(numerator / denominator) * 2^-bits to a few units in the last place, without overflow on the way.
inline double root_of_fraction(const Integer& numerator, const Integer& denominator, int bits) {
  if (numerator == 0) return 0;
  const int size = static_cast<int>(msb(numerator)) - static_cast<int>(msb(denominator));
  int shift = 120 - size;
  shift += shift & 1;
  Integer quotient =
      shift >= 0 ? Integer((numerator << shift) / denominator) : Integer(numerator / (denominator << -shift));
  const int drop = static_cast<int>(msb(quotient)) - 62;
  quotient >>= drop;
  const auto top = static_cast<long double>(static_cast<std::uint64_t>(quotient));
  // The exponent under the root may be odd: multiply by the root of two afterwards.
  const int exponent = drop - shift;
  const int half = exponent >> 1;
  const long double root = std::sqrt((exponent & 1) ? 2 * top : top);
  return static_cast<double>(std::ldexp(root, half - bits));
}

}  // namespace selvage::oracle
