#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
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
  constexpr int kDigits = std::numeric_limits<double>::digits, kBias = std::numeric_limits<double>::max_exponent - 1;
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto biased = static_cast<int>(bits >> (kDigits - 1) & (2 * kBias + 1));
  std::uint64_t mantissa = bits & ((std::uint64_t{1} << (kDigits - 1)) - 1);
  if (biased != 0) mantissa |= std::uint64_t{1} << (kDigits - 1);
  if (mantissa == 0) return {};
  const int trailing_zeros = std::countr_zero(mantissa);
  const auto magnitude = static_cast<std::int64_t>(mantissa >> trailing_zeros);
  return {value < 0 ? -magnitude : magnitude, std::max(biased, 1) - kBias - (kDigits - 1) + trailing_zeros};
}

/// Finite doubles as integers times 2^exponent, the smallest such: each is its mantissa times 2 to its own exponent.
template <std::size_t N>
struct CommonDyadic {
  std::array<DyadicNumber, N> numbers;  ///< exponents from 0 on
  int exponent = 0;                     ///< 0 when all values are zero
  int bits = 0;                         ///< of the largest integer, without its sign

  template <class Int>
  Int integer(std::size_t i) const {
    Int result(numbers[i].mantissa);
    result <<= static_cast<unsigned>(numbers[i].exponent);
    return result;
  }
};

template <std::size_t N>
CommonDyadic<N> to_common_dyadic(const std::array<double, N>& values) {
  CommonDyadic<N> result;
  int common = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < N; ++i) {
    result.numbers[i] = to_dyadic(values[i]);
    if (result.numbers[i].mantissa != 0) common = std::min(common, result.numbers[i].exponent);
  }
  if (common == std::numeric_limits<int>::max()) return result;
  result.exponent = common;
  for (DyadicNumber& number : result.numbers) {
    if (number.mantissa == 0) continue;
    number.exponent -= common;
    const auto magnitude = static_cast<std::uint64_t>(std::abs(number.mantissa));
    result.bits = std::max(result.bits, static_cast<int>(std::bit_width(magnitude)) + number.exponent);
  }
  return result;
}

/// Multiplies finite doubles of any magnitude, denormals included, by one common power of two that makes all of them
/// integers, and the smallest such. The sign of a homogeneous polynomial of the values stays what it was.
///
/// @return the exponent e: values[i] = integers[i] * 2^e exactly; 0 when all values are zero
template <std::size_t N>
int to_common_integers(const std::array<double, N>& values, std::array<ExactInt, N>& integers) {
  const CommonDyadic<N> common = to_common_dyadic(values);
  for (std::size_t i = 0; i < N; ++i) integers[i] = common.template integer<ExactInt>(i);
  return common.exponent;
}

/// -1, 0 or 1.
inline int sign_of(const ExactInt& value) {
  return value.sign();
}

}  // namespace selvage
