#include "geometry/exact/exact_integer.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "test_scale.h"

namespace selvage {
namespace {

using boost::multiprecision::cpp_rational;

cpp_rational power_of_two(int exponent) {
  const boost::multiprecision::cpp_int power = boost::multiprecision::cpp_int(1) << std::abs(exponent);
  return exponent >= 0 ? cpp_rational(power) : cpp_rational(1, power);
}

template <std::size_t N>
void expect_exact_scaling(const std::array<double, N>& values) {
  std::array<ExactInt, N> integers;
  const cpp_rational unit = power_of_two(to_common_integers(values, integers));
  bool any_odd = false, all_zero = true;
  for (std::size_t i = 0; i < N; ++i) {
    EXPECT_EQ(cpp_rational(integers[i]) * unit, cpp_rational(values[i])) << values[i];
    any_odd |= bit_test(abs(integers[i]), 0);
    all_zero &= values[i] == 0;
  }
  EXPECT_TRUE(any_odd || all_zero) << "not the smallest integers";
}

TEST(ExactInteger, ScalesDenormalsHugeAndMixedValuesExactly) {
  using Limits = std::numeric_limits<double>;
  expect_exact_scaling<3>({0.0, -0.0, 0.0});
  expect_exact_scaling<3>({1.0, -2.0, 0.5});
  expect_exact_scaling<3>({Limits::denorm_min(), -Limits::denorm_min(), 0.0});
  expect_exact_scaling<4>({Limits::max(), Limits::denorm_min(), -1e150, 3e-150});
  expect_exact_scaling<3>({Limits::lowest(), Limits::max(), -0.1});
  expect_exact_scaling<3>({Limits::min(), -Limits::min() * 0.75, 1.0});
}

TEST(ExactInteger, ScalesRandomBitPatternsExactly) {
  std::mt19937_64 random(1);
  for (std::int64_t k = 0; k < test::scaled(2000); ++k) {
    std::array<double, 6> values;
    for (double& value : values) {
      do value = std::bit_cast<double>(random());
      while (!std::isfinite(value));
    }
    expect_exact_scaling<6>(values);
  }
}

TEST(ExactInteger, SmallValuesGiveSmallIntegers) {
  std::array<ExactInt, 3> integers;
  EXPECT_EQ(to_common_integers<3>({6.0, -1.5, 0.0}, integers), -1);
  EXPECT_EQ(integers[0], 12);
  EXPECT_EQ(integers[1], -3);
  EXPECT_EQ(integers[2], 0);
}

TEST(ExactInteger, ProductsBeyondTheInlineBitsStayExact) {
  std::array<ExactInt, 2> integers;
  to_common_integers<2>({std::ldexp(1.0, 1000), std::ldexp(1.0, -1074)}, integers);
  const ExactInt huge = integers[0] * integers[0] * integers[0] + integers[1];
  EXPECT_EQ(msb(huge), 3u * 2074u);
  EXPECT_EQ(sign_of(huge - integers[0] * integers[0] * integers[0]), 1);
  EXPECT_EQ(sign_of(integers[1] - huge), -1);
  EXPECT_EQ(sign_of(huge - huge), 0);
}

TEST(ExactInteger, DyadicMantissaIsOddOrZero) {
  EXPECT_EQ(to_dyadic(0.0).mantissa, 0);
  EXPECT_EQ(to_dyadic(-96.0).mantissa, -3);
  EXPECT_EQ(to_dyadic(-96.0).exponent, 5);
  EXPECT_EQ(to_dyadic(std::numeric_limits<double>::denorm_min()).mantissa, 1);
  EXPECT_EQ(to_dyadic(std::numeric_limits<double>::denorm_min()).exponent, -1074);
}

}  // namespace
}  // namespace selvage
