#include "geometry/exact/fixed_root.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/exact/real_root.h"
#include "geometry/exact_oracle.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::quota;
using test::RandomSource;
using test::scaled;

template <int Degree>
using Numbers = std::array<std::int64_t, Degree + 1>;

template <int Degree>
Numbers<Degree> product(const Numbers<Degree - 1>& p, std::int64_t constant, std::int64_t slope) {
  Numbers<Degree> result{};
  for (int i = 0; i < Degree; ++i) {
    result[i] += constant * p[i];
    result[i + 1] += slope * p[i];
  }
  return result;
}

/// The kinds of roots: anywhere, at fractions of small numbers, at powers of two, tiny, or twice the same.
std::array<std::int64_t, 2> random_factor(RandomSource& random) {
  switch (random.integer(0, 3)) {
    case 0:
      return {random.integer(-100'000, 100'000), random.integer(-100'000, 100'000)};
    case 1:
      return {-random.integer(0, 8), random.integer(-8, 8)};
    case 2:
      return {-random.integer(0, 16), 16};
    default:
      return {-random.integer(0, 2), random.integer(-1'000'000, 1'000'000)};
  }
}

Numbers<1> random_numbers(RandomSource& random, std::integral_constant<int, 1>) {
  return random_factor(random);
}
template <int Degree>
Numbers<Degree> random_numbers(RandomSource& random, std::integral_constant<int, Degree>) {
  const auto lower = random_numbers(random, std::integral_constant<int, Degree - 1>());
  const auto [constant, slope] = random_factor(random);
  Numbers<Degree> result = product<Degree>(lower, constant, slope);
  if (random.integer(0, 2) == 0) result[random.integer(0, Degree)] += random.integer(-1, 1);
  return result;
}

template <class Int, std::size_t Count>
auto with_coefficients(const std::array<std::int64_t, Count>& numbers) {
  Polynomial<Int, static_cast<int>(Count) - 1> result;
  for (std::size_t i = 0; i < Count; ++i) result.coefficients[i] = Int(numbers[i]);
  return result;
}

struct RootFacts {
  std::optional<int> step;
  std::vector<std::optional<int>> signs;
};

/// All roots, in order, with the signs of some polynomials there.
template <class Int, std::size_t Count>
std::optional<std::vector<RootFacts>> facts_about_roots(const std::array<std::int64_t, Count>& numbers,
                                                        const std::vector<Numbers<2>>& others) {
  std::vector<RootFacts> facts;
  const auto visit = [&](auto&& root) {
    RootFacts& fact = facts.emplace_back();
    for (const auto& other : others) fact.signs.push_back(root.sign_of_value(with_coefficients<Int>(other)));
    fact.signs.push_back(root.sign_of_value(with_coefficients<Int>(numbers)));
    fact.step = root.step(20);
  };
  if (!visit_roots(with_coefficients<Int>(numbers), visit)) return std::nullopt;
  return facts;
}

/// Fixed integers decide as those of any size do, and they decide nearly every sign that is not zero.
template <int Degree>
void compare_with_real_roots(std::uint64_t seed) {
  RandomSource random(seed);
  const std::int64_t count = scaled(6'000, 300);
  std::int64_t roots = 0, signs = 0, missed_roots = 0, missed_signs = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const Numbers<Degree> numbers = random_numbers(random, std::integral_constant<int, Degree>());
    if (numbers == Numbers<Degree>{}) continue;
    std::vector<Numbers<2>> others;
    for (int i = 0; i < 3; ++i) others.push_back(random_numbers(random, std::integral_constant<int, 2>()));
    const auto expected = *facts_about_roots<ExactInt>(numbers, others);
    const auto found = facts_about_roots<FixedInt<3>>(numbers, others);
    missed_roots += !found;
    if (!found) continue;
    ASSERT_EQ(found->size(), expected.size()) << "input " << n;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ++roots;
      if (const auto step = (*found)[i].step) {
        ASSERT_EQ(*step, *expected[i].step) << "input " << n;
      }
      missed_roots += !(*found)[i].step;
      ASSERT_EQ((*found)[i].signs.back(), 0) << "input " << n;
      for (std::size_t k = 0; k < expected[i].signs.size(); ++k) {
        const auto sign = (*found)[i].signs[k], right = expected[i].signs[k];
        ASSERT_TRUE(!sign || sign == right) << "input " << n;
        signs += right != 0;
        missed_signs += right != 0 && !sign;
      }
    }
  }
  EXPECT_LE(missed_roots, count / 10);
  EXPECT_LE(missed_signs, signs / 1000);
  EXPECT_GT(roots, quota(count, 1.0 / 4));
}

TEST(FixedRoot, EqualsTheRealRootOfLines) {
  compare_with_real_roots<1>(1);
}
TEST(FixedRoot, EqualsTheRealRootsOfParabolas) {
  compare_with_real_roots<2>(2);
}
TEST(FixedRoot, EqualsTheRealRootsOfCubics) {
  compare_with_real_roots<3>(3);
}

std::vector<std::optional<int>> steps_of(const Numbers<3>& numbers) {
  std::vector<std::optional<int>> steps;
  visit_roots(with_coefficients<FixedInt<3>>(numbers), [&](auto&& root) { steps.push_back(root.step(20)); });
  return steps;
}

TEST(FixedRoot, ByHand) {
  using Steps = std::vector<std::optional<int>>;
  EXPECT_EQ(steps_of({-1, 2, 0, 0}), Steps{(1 << 19) - 1});  // what is at the end of a step is in it
  EXPECT_EQ(steps_of({0, -1, 1, 0}), Steps{});               // at 0 and at 1
  EXPECT_EQ(steps_of({1, 0, 1, 0}), Steps{});                // nowhere
  EXPECT_EQ(steps_of({0, 0, -1, 3}), Steps{(1 << 20) / 3});  // and twice at 0
  EXPECT_EQ(steps_of({-1, std::int64_t{1} << 60, 0, 0}), Steps{0});
  EXPECT_EQ(steps_of({1, -3'000'001, 2'000'000'000'000, 0}), (Steps{0, 1}));  // close to each other, close to 0
  const Numbers<3> twice{4, -12, 9, 0};
  EXPECT_FALSE(visit_roots(with_coefficients<FixedInt<3>>(twice), [](auto&&) {}));
}

/// `make_pair(number)` gives a polynomial, and another that shares a root with it.
template <class Int, class MakePair>
void expect_known_zeros(std::uint64_t seed, MakePair&& make_pair) {
  RandomSource random(seed);
  const std::int64_t count = scaled(6'000, 300);
  std::int64_t zeros = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const auto [polynomial, other] = make_pair([&random] { return random.integer(-100'000, 100'000); });
    const auto found = facts_about_roots<Int>(polynomial, {other});
    if (!found) continue;
    const auto expected = *facts_about_roots<ExactInt>(polynomial, {other});
    ASSERT_EQ(found->size(), expected.size()) << "input " << n;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const auto sign = (*found)[i].signs[0], right = expected[i].signs[0];
      zeros += right == 0;
      ASSERT_TRUE(sign == right || (!sign && right != 0)) << "input " << n << ", root " << i;
    }
  }
  EXPECT_GT(zeros, quota(count, 1.0 / 4));
}

/// Where a volume is a distance times an area, one of the area's roots is one of the volume's, and rarely a fraction.
TEST(FixedRoot, KnowsTheZeroOfAFactor) {
  expect_known_zeros<FixedInt<3>>(4, [](auto&& number) {
    const Numbers<2> area{number(), number(), number() % 4 == 0 ? 0 : number()};
    return std::pair(product<3>(area, number(), number()), area);
  });
}

/// Where two areas share a factor, neither need be a multiple of the other.
TEST(FixedRoot, KnowsTheZeroOfACommonFactor) {
  expect_known_zeros<FixedInt<2>>(6, [](auto&& number) {
    const Numbers<1> shared{number(), number()};
    return std::pair(product<2>(shared, number(), number()), product<2>(shared, number(), number()));
  });
}

/// Its degree; -1 where both polynomials are zero.
template <class P, class Q>
int degree_of_common_divisor(const P& p, const Q& q) {
  if (p.is_zero() && q.is_zero()) return -1;
  int degree = 0;
  visit_common_divisor(p, q, [&degree](const auto& divisor) { return (degree = divisor.degree()) > 0; });
  return degree;
}

/// Of a volume, with coefficients of three words, areas of two and lines of one, as in the conditions of a meeting.
template <class Int>
std::array<int, 6> degrees_of_common_divisors(const std::array<Numbers<1>, 4>& lines, bool is_moved) {
  const auto first = with_coefficients<Int>(lines[0]), second = with_coefficients<Int>(lines[1]);
  const auto third = with_coefficients<Int>(lines[2]), fourth = with_coefficients<Int>(lines[3]);
  const auto area = first * second - third * fourth;
  auto product = first * third;
  auto volume = area * third;
  if (is_moved) {
    volume[1] += decltype(Int() * Int() * Int())(1);
    product[0] += decltype(Int() * Int())(1);
  }
  return {degree_of_common_divisor(volume, area),    degree_of_common_divisor(volume, third),
          degree_of_common_divisor(volume, product), degree_of_common_divisor(product, first * second),
          degree_of_common_divisor(first, product),  degree_of_common_divisor(area, area)};
}

TEST(Polynomial, HasTheCommonDivisorByFixedIntegersAsByAnyOnes) {
  RandomSource random(5);
  const std::int64_t count = scaled(20'000, 1'000);
  for (std::int64_t n = 0; n < count; ++n) {
    // Up to the largest number of bits, or small with zeros among them.
    const std::int64_t largest = n % 2 == 0 ? (std::int64_t{1} << 61) - 1 : 3;
    std::array<Numbers<1>, 4> lines;
    for (Numbers<1>& numbers : lines)
      for (std::int64_t& c : numbers)
        c = n % 8 == 0 ? largest * random.integer(-1, 1) : random.integer(-largest, largest);
    for (const bool is_moved : {false, true})
      ASSERT_EQ(degrees_of_common_divisors<FixedInt<1>>(lines, is_moved),
                degrees_of_common_divisors<ExactInt>(lines, is_moved))
          << "input " << n;
    const auto degrees = degrees_of_common_divisors<FixedInt<1>>(lines, false);
    const auto is_zero = [](const Numbers<1>& line) { return line == Numbers<1>{}; };
    if (std::any_of(lines.begin(), lines.end(), is_zero)) continue;
    ASSERT_GE(degrees[1], lines[2][1] != 0 ? 1 : 0) << "input " << n;
    ASSERT_GE(degrees[3], lines[0][1] != 0 ? 1 : 0) << "input " << n;
    ASSERT_GE(degrees[4], lines[0][1] != 0 ? 1 : 0) << "input " << n;
  }
}

TEST(Polynomial, HasTheCommonDivisorByHand) {
  const auto degree = [](const auto& p, const auto& q) {
    return degree_of_common_divisor(with_coefficients<FixedInt<2>>(p), with_coefficients<FixedInt<1>>(q));
  };
  EXPECT_EQ(degree(Numbers<2>{-1, 0, 1}, Numbers<1>{1, 1}), 1);      // (t + 1) (t - 1)
  EXPECT_EQ(degree(Numbers<2>{-1, 0, 1}, Numbers<2>{-2, 2, 0}), 1);  // and 2 (t - 1)
  EXPECT_EQ(degree(Numbers<2>{-1, 0, 1}, Numbers<1>{2, 1}), 0);
  EXPECT_EQ(degree(Numbers<1>{1, 1}, Numbers<2>{1, 2, 1}), 1);  // and its square
  EXPECT_EQ(degree(Numbers<3>{0, 2, 4, 2}, Numbers<2>{1, 2, 1}), 2);
  EXPECT_EQ(degree(Numbers<3>{0, 1, 3, 2}, Numbers<2>{1, 2, 1}), 1);  // t (t + 1) (2 t + 1)
  EXPECT_EQ(degree(Numbers<3>{1, 2, 3, 4}, Numbers<1>{7, 0}), 0);
  EXPECT_EQ(degree(Numbers<2>{}, Numbers<1>{1, 1}), 1);
  EXPECT_EQ(degree(Numbers<2>{1, 0, 2}, Numbers<1>{}), 2);
}

}  // namespace
}  // namespace selvage
