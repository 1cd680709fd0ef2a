#include "selvage/geometry/continuous.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/continuous_motions.h"
#include "geometry/continuous_pairs.h"
#include "geometry/exact/continuous_exact.h"
#include "geometry/tarski_oracle.h"
#include "test_scale.h"

namespace selvage {
namespace {

using test::hostile_doubles;
using test::impact;
using test::kEdgeEdge;
using test::kind_of;
using test::kVertexFace;
using test::LatticeMotion;
using test::meet;
using test::quota;
using test::random_doubles;
using test::random_motion;
using test::RandomSource;
using test::scaled;
using test::to_points;

bool meet_by_definition(ContinuousPair pair, const test::ExactMotion& motion) {
  return pair == kVertexFace ? test::ever_meet_by_definition<1>(motion) : test::ever_meet_by_definition<2>(motion);
}

MovingPoints reversed(const MovingPoints& points) {
  return {points.t1, points.t0};
}

void compare_lattice_with_definition(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t met = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticeMotion lattice = random_motion(random, pair, kind_of(n));
    const double scale = n % 5 == 0 ? std::ldexp(1.0, static_cast<int>(random.integer(-1074, 1015))) : 1;
    const MovingPoints points = to_points(lattice, scale);
    const bool expected = meet_by_definition(pair, test::to_motion(lattice));
    met += expected;
    ASSERT_EQ(meets_exactly(pair, points), expected) << "input " << n;
    ASSERT_EQ(meet(pair, points), expected) << "input " << n;
    ASSERT_EQ(meet(pair, reversed(points)), expected) << "input " << n;
  }
  EXPECT_GT(met, quota(count, 1.0 / 5));
  EXPECT_GT(count - met, quota(count, 1.0 / 5));
}

TEST(VertexFace, EqualsTheDefinitionOnLattices) {
  compare_lattice_with_definition(kVertexFace, 1, scaled(2'500, 200));
}
TEST(EdgeEdge, EqualsTheDefinitionOnLattices) {
  compare_lattice_with_definition(kEdgeEdge, 2, scaled(2'000, 200));
}

/// Coordinates 0 and 1 only: the most degenerate of all.
void compare_unit_cube_with_definition(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  for (std::int64_t n = 0; n < count; ++n) {
    LatticeMotion lattice;
    for (auto& point : lattice)
      for (auto& c : point) c = random.integer(0, 1);
    const bool expected = meet_by_definition(pair, test::to_motion(lattice));
    ASSERT_EQ(meet(pair, to_points(lattice, 0.1)), expected) << "input " << n;
    ASSERT_EQ(meets_exactly(pair, to_points(lattice)), expected) << "input " << n;
  }
}

TEST(VertexFace, EqualsTheDefinitionOnTheUnitCube) {
  compare_unit_cube_with_definition(kVertexFace, 3, scaled(1'500));
}
TEST(EdgeEdge, EqualsTheDefinitionOnTheUnitCube) {
  compare_unit_cube_with_definition(kEdgeEdge, 4, scaled(1'500));
}

template <class T>
std::array<test::ExactVec<T>, 8> exact_places(const MovingPoints& points) {
  std::array<Vec3, 8> all;
  std::copy(points.t0.begin(), points.t0.end(), all.begin());
  std::copy(points.t1.begin(), points.t1.end(), all.begin() + 4);
  return test::to_exact<T>(all);
}

template <class T>
test::ExactMotion exact_motion(const MovingPoints& points) {
  return test::to_motion(exact_places<T>(points));
}

void compare_doubles_with_definition(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t met = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const MovingPoints points = hostile_doubles(random, pair, n);
    const bool expected = meet_by_definition(pair, exact_motion<test::Unlimited>(points));
    met += expected;
    ASSERT_EQ(meet(pair, points), expected) << "input " << n;
    ASSERT_EQ(meets_exactly(pair, points), expected) << "input " << n;
  }
  EXPECT_GT(met, quota(count, 1.0 / 10));
  EXPECT_GT(count - met, quota(count, 1.0 / 5));
}

TEST(VertexFace, EqualsTheDefinitionOnDoubles) {
  compare_doubles_with_definition(kVertexFace, 5, scaled(1'500, 200));
}
TEST(EdgeEdge, EqualsTheDefinitionOnDoubles) {
  compare_doubles_with_definition(kEdgeEdge, 6, scaled(1'000, 200));
}

TEST(ContinuousPairs, EqualTheDefinitionOnAnyDoubles) {
  RandomSource random(7);
  for (std::int64_t n = 0; n < scaled(2); ++n) {
    MovingPoints points;
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        points.t0[i][k] =
            n % 2 == 0 ? random.any_finite() : random.uniform() * (random.integer(0, 1) == 0 ? 1e150 : 1e-150);
        points.t1[i][k] =
            n % 2 == 0 ? random.any_finite() : random.uniform() * (random.integer(0, 1) == 0 ? 1e150 : 1e-150);
      }
    for (ContinuousPair pair : {kVertexFace, kEdgeEdge})
      ASSERT_EQ(meet(pair, points), meet_by_definition(pair, exact_motion<test::Unlimited>(points))) << "input " << n;
  }
}

/// The filter, the stage of fixed integers and that of any agree where the oracle would be too slow.
void compare_stages(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t wrong = 0, wrong_steps = 0, resting = 0, resting_undecided = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const bool is_lattice = n % 4 == 0, is_resting = !is_lattice && n % 3 == 0;
    const MovingPoints points =
        is_lattice ? to_points(random_motion(random, pair, kind_of(n / 4)), 0.1) : hostile_doubles(random, pair, n);
    const auto last_step = static_cast<int>(random.integer(0, 1) == 0 ? kTimeSteps : random.integer(1, kTimeSteps));
    const int expected = first_step_by_any_integers(pair, points, last_step);
    const auto by_fixed = first_step_by_fixed_integers(pair, points, last_step);
    resting += is_resting;
    resting_undecided += is_resting && !by_fixed;
    wrong_steps += by_fixed && *by_fixed != expected;
    wrong += last_step == kTimeSteps && meet(pair, points) != (expected < kTimeSteps);
  }
  EXPECT_EQ(wrong, 0) << "of " << count;
  EXPECT_EQ(wrong_steps, 0) << "of " << count;
  EXPECT_LE(resting_undecided, resting / 20 + 1);
}

TEST(VertexFace, StagesAgree) {
  compare_stages(kVertexFace, 8, scaled(12'000));
}
TEST(EdgeEdge, StagesAgree) {
  compare_stages(kEdgeEdge, 9, scaled(12'000));
}

/// The part of a motion between two times, exactly, in steps of 2^-24 of the whole.
template <class T>
test::ExactMotion part_of_time(const std::array<test::ExactVec<T>, 8>& places, std::int64_t first, std::int64_t last) {
  constexpr std::int64_t kWhole = 1 << 24;
  std::array<test::ExactVec<T>, 8> part;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      part[i][k] = places[i][k] * (kWhole - first) + places[4 + i][k] * first;
      part[4 + i][k] = places[i][k] * (kWhole - last) + places[4 + i][k] * last;
    }
  return test::to_motion(part);
}

/// The first step is the one up to whose end they meet, while up to its start they do not.
void compare_first_step_with_definition(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t later = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const MovingPoints points =
        n % 4 == 0 ? to_points(random_motion(random, pair, kind_of(n / 4))) : hostile_doubles(random, pair, n);
    const auto places = exact_places<test::Unlimited>(points);
    const auto meet_until = [&](std::int64_t step) {
      return meet_by_definition(pair, part_of_time(places, 0, step * 16));
    };
    const auto last_step = static_cast<int>(random.integer(0, 2) == 0 ? kTimeSteps : random.integer(1, kTimeSteps));
    const int found = first_step_exactly(pair, points, last_step);
    ASSERT_EQ(found < last_step, meet_until(last_step)) << "input " << n;
    if (found == last_step) continue;
    ASSERT_TRUE(meet_until(found + 1)) << "too early, input " << n;
    if (found == 0) continue;
    ASSERT_FALSE(meet_until(found)) << "too late, input " << n;
    ++later;
  }
  EXPECT_GT(later, quota(count, 1.0 / 100));
}

TEST(VertexFace, FirstStepEqualsTheDefinition) {
  compare_first_step_with_definition(kVertexFace, 14, scaled(1'500, 200));
}
TEST(EdgeEdge, FirstStepEqualsTheDefinition) {
  compare_first_step_with_definition(kEdgeEdge, 15, scaled(1'500, 200));
}

/// All orders of a face's vertices; both orders of each edge's ends and of the edges; both directions of time.
void compare_orders(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t different = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const MovingPoints points =
        n % 2 == 0 ? random_doubles(random, pair, 1) : to_points(random_motion(random, pair, kind_of(n / 2)), 0.1);
    const bool expected = meet(pair, points);
    std::array<int, 4> order{0, 1, 2, 3};
    do {
      const bool same_sets = pair == kVertexFace ? order[0] == 0 : order[0] / 2 == order[1] / 2;
      if (!same_sets) continue;
      MovingPoints other;
      for (int i = 0; i < 4; ++i) {
        other.t0[i] = points.t0[order[i]];
        other.t1[i] = points.t1[order[i]];
      }
      different += meet(pair, other) != expected || meet(pair, reversed(other)) != expected;
    } while (std::next_permutation(order.begin(), order.end()));
  }
  EXPECT_EQ(different, 0);
}

TEST(VertexFace, IsTheSameInEveryOrder) {
  compare_orders(kVertexFace, 10, scaled(600));
}
TEST(EdgeEdge, IsTheSameInEveryOrder) {
  compare_orders(kEdgeEdge, 11, scaled(600));
}

void compare_impact_with_definition(ContinuousPair pair, std::uint64_t seed, std::int64_t count) {
  RandomSource random(seed);
  std::int64_t met = 0, later = 0;
  for (std::int64_t n = 0; n < count; ++n) {
    const LatticeMotion lattice = random_motion(random, pair, kind_of(n));
    const MovingPoints points = to_points(lattice);
    const auto found = impact(pair, points);
    ASSERT_EQ(found.has_value(), meet(pair, points)) << "input " << n;
    if (!found) continue;
    ++met;
    later += *found > 0;
    ASSERT_GE(*found, 0);
    ASSERT_LE(*found, 1);
    const auto step = static_cast<std::int64_t>(*found * (1 << 24));
    EXPECT_TRUE(meet_by_definition(pair, part_of_time(lattice, step, step + (1 << 4)))) << "too early, input " << n;
    if (step > 0) {
      EXPECT_FALSE(meet_by_definition(pair, part_of_time(lattice, 0, step - 1))) << "too late, input " << n;
    }
    EXPECT_EQ(impact(pair, points, *found + 0x1p-30), found) << "input " << n;
    EXPECT_EQ(impact(pair, points, (1 + 2 * *found) / 3), found) << "input " << n;
    EXPECT_EQ(impact(pair, points, *found), std::nullopt) << "input " << n;
    EXPECT_EQ(impact(pair, points, *found / 2), std::nullopt) << "input " << n;
  }
  EXPECT_GT(met, quota(count, 1.0 / 5));
  EXPECT_GT(later, quota(count, 1.0 / 100));
}

TEST(VertexFace, ImpactIsTheFirst) {
  compare_impact_with_definition(kVertexFace, 12, scaled(400, 100));
}
TEST(EdgeEdge, ImpactIsTheFirst) {
  compare_impact_with_definition(kEdgeEdge, 13, scaled(400, 100));
}

}  // namespace
}  // namespace selvage
