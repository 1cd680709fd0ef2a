#include "geometry/exact/fixed_root.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <optional>
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

}  // namespace
}  // namespace selvage
