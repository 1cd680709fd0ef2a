#include "geometry/exact/fixed_integer.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/exact/exact_integer.h"
#include "geometry/exact_oracle.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::RandomSource;
using test::scaled;

template <int Words>
ExactInt value_of(const FixedInt<Words>& number) {
  ExactInt result = number.sign() < 0 ? -1 : 0;
  for (int i = Words - 1; i >= 0; --i) result = (result << 64) + number.word(i);
  return result;
}

/// Words that are often all zeros or all ones, where carries run through.
template <int Words>
FixedInt<Words> random_number(RandomSource& random) {
  FixedInt<Words> number;
  for (int i = 0; i < Words; ++i) {
    constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
    const std::int64_t words[] = {
        0, -1, 1, -2, kLargest, -kLargest - 1, std::bit_cast<std::int64_t>(random.any_finite())};
    number <<= 64;
    number += FixedInt<Words>(words[random.integer(0, 6)]);
  }
  return number;
}

/// As much of a number as fits into so many words, in two's complement.
template <int Words>
ExactInt wrapped(const ExactInt& value) {
  const ExactInt range = ExactInt(1) << (64 * Words);
  ExactInt rest = value % range;
  if (rest < 0) rest += range;
  return 2 * rest >= range ? ExactInt(rest - range) : rest;
}

template <int First, int Second>
void compare_with_exact(std::uint64_t seed) {
  RandomSource random(seed);
  for (std::int64_t n = 0; n < scaled(2'000); ++n) {
    const auto a = random_number<First>(random), b = random_number<First>(random);
    const auto c = random_number<Second>(random);
    const ExactInt x = value_of(a), y = value_of(b), z = value_of(c);
    ASSERT_EQ(a.sign(), x.sign());
    ASSERT_EQ(a == b, x == y);
    ASSERT_EQ(value_of(a + b), wrapped<First>(x + y));
    ASSERT_EQ(value_of(a - b), wrapped<First>(x - y));
    ASSERT_EQ(value_of(a * c), x * z);
    ASSERT_EQ(value_of(c * a), x * z);
    ASSERT_EQ(value_of(FixedInt<Second>(a)), wrapped<Second>(x));
    const auto bits = static_cast<unsigned>(random.integer(0, 64 * First - 1));
    FixedInt<First> shifted = a;
    shifted <<= bits;
    ASSERT_EQ(value_of(shifted), wrapped<First>(x << bits));
    const auto expected = static_cast<double>(x);
    ASSERT_LE(std::abs(static_cast<double>(a) - expected), 0x1p-50 * std::abs(expected));
  }
}

TEST(FixedInteger, EqualsIntegersThatGrow) {
  compare_with_exact<1, 1>(1);
  compare_with_exact<2, 1>(2);
  compare_with_exact<3, 2>(3);
  compare_with_exact<1, 6>(4);
  compare_with_exact<6, 6>(5);
}

TEST(FixedInteger, TakesNumbersOfOneWord) {
  for (const std::int64_t value : {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{1} << 62,
                                   std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(value_of(FixedInt<1>(value)), value);
    EXPECT_EQ(value_of(FixedInt<3>(value)), value);
    EXPECT_EQ(static_cast<double>(FixedInt<3>(value)), static_cast<double>(value));
  }
}

}  // namespace
}  // namespace selvage
