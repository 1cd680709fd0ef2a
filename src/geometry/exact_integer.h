#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace selvage {

/// Integer of any size. Up to 1024 bits live inside the object, which is enough for a polynomial of degree 4 of
/// coordinates of similar magnitude; wider ones spill to the heap. No expression templates, so that `auto` is a value.
using ExactInt = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<1024, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked>,
    boost::multiprecision::et_off>;

/// A finite double as `mantissa * 2^exponent` with an odd mantissa; zero is {0, 0}.
struct DyadicNumber {
  std::int64_t mantissa = 0;
  int exponent = 0;
};

inline DyadicNumber to_dyadic(double value) {
  if (value == 0) return {};
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  constexpr int kDigits = std::numeric_limits<double>::digits;
  const auto mantissa = static_cast<std::int64_t>(std::ldexp(fraction, kDigits));
  const int trailing_zeros = __builtin_ctzll(static_cast<std::uint64_t>(mantissa));
  return {mantissa / (std::int64_t{1} << trailing_zeros), exponent - kDigits + trailing_zeros};
}

/// Multiplies finite doubles of any magnitude, denormals included, by one common power of two that makes all of them
/// integers, and the smallest such. The sign of a homogeneous polynomial of the values stays what it was.
///
/// @return the exponent e: values[i] = integers[i] * 2^e exactly; 0 when all values are zero
template <std::size_t N>
int to_common_integers(const std::array<double, N>& values, std::array<ExactInt, N>& integers) {
  std::array<DyadicNumber, N> dyadic;
  int common = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < N; ++i) {
    dyadic[i] = to_dyadic(values[i]);
    if (dyadic[i].mantissa != 0) common = std::min(common, dyadic[i].exponent);
  }
  if (common == std::numeric_limits<int>::max()) common = 0;
  for (std::size_t i = 0; i < N; ++i) {
    integers[i] = dyadic[i].mantissa;
    if (dyadic[i].mantissa != 0) integers[i] <<= dyadic[i].exponent - common;
  }
  return common;
}

/// -1, 0 or 1.
inline int sign_of(const ExactInt& value) {
  return value.sign();
}

}  // namespace selvage
