#include "self_collision/culling_surfaces.h"
#include "selvage/self_collision/continuous_collision.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

constexpr CullingMethod kAccurateForSteps[] = {CullingMethod::kNormalCone, CullingMethod::kEnhancedDualCone,
                                               CullingMethod::kAuto};
constexpr CullingMethod kPublished[] = {CullingMethod::kDualCone, CullingMethod::kDualConeInternal,
                                        CullingMethod::kEnhancedDualConePublished};

SelfCollisionOptions moving_by(CullingMethod method) {
  SelfCollisionOptions options;
  options.method = method;
  return options;
}

ContinuousPairs pairs_by(CullingMethod method, const Surface& start, const Positions& end,
                         ContinuousCounters* counters = nullptr) {
  const TriangleMesh mesh = start.mesh();
  return ContinuousCollisionFinder(mesh, start.positions, end, moving_by(method)).find_pairs(counters);
}

void expect_all_agree(const Surface& start, const Positions& end) {
  const ContinuousPairs expected = pairs_by(CullingMethod::kBvh, start, end);
  for (const CullingMethod method : kAccurateForSteps)
    ASSERT_EQ(pairs_by(method, start, end), expected) << culling_method_names()[static_cast<int>(method)];
}

/// The end of a step: each vertex moved by itself, or along a wave that all of them feel, or the surface turned.
Positions step_from(const Surface& start, double strength, Random& random) {
  Positions end = surfaces::jittered(start, strength * random.unit() * random.unit(), random).positions;
  const Vec3 wave(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
  const Vec3 direction(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
  const double phase = random.within(0, 6), turn = random.below(3) == 0 ? random.within(-2, 2) : 0;
  for (Vec3& x : end) {
    x += strength * std::sin(wave.dot(x) + phase) * direction;
    x = Vec3(x[0], std::cos(turn) * x[1] - std::sin(turn) * x[2], std::sin(turn) * x[1] + std::cos(turn) * x[2]);
  }
  return end;
}

class ContinuousCullingOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, ContinuousCullingOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(ContinuousCullingOf, ChangesNoAnswer) {
  constexpr double kStrengths[] = {0, 0.01, 0.1, 1, 5};
  Random random(31);
  for (std::int64_t n = 0; n < scaled(60); ++n) {
    Surface start = GetParam().make(random);
    if (n % 3 == 0) start = surfaces::snapped(start, 3);
    Positions end = step_from(start, kStrengths[n % 5], random);
    if (n % 6 == 0) end = surfaces::snapped({end, start.triangles}, 3).positions;
    ASSERT_NO_FATAL_FAILURE(expect_all_agree(start, end)) << n;
  }
}

TEST(ContinuousCulling, ChangesNoAnswerOnCombs) {
  for (const double lean : {0.0, 0.5, 1.0}) {
    const Surface start = surfaces::comb(lean);
    const Positions end = surfaces::comb(lean + 0.4).positions;
    const ContinuousPairs pairs = pairs_by(CullingMethod::kBvh, start, end);
    EXPECT_EQ(pairs.vertex_face.empty() && pairs.edge_edge.empty(), lean == 0) << lean;
    ASSERT_NO_FATAL_FAILURE(expect_all_agree(start, end)) << lean;
  }
}

// Large enough that there is something to cull; every method must have culled its share in all.
TEST(ContinuousCulling, ChangesNoAnswerOnWavedSheets) {
  Random random(32);
  std::int64_t culled[3] = {}, triangles = 0, pairs = 0;
  for (std::int64_t n = 0; n < scaled(200); ++n) {
    const Surface start = surfaces::waved_sheet(random);
    const Positions end = step_from(start, std::pow(random.unit(), 4) * 3, random);
    ContinuousCounters none;
    const ContinuousPairs expected = pairs_by(CullingMethod::kBvh, start, end, &none);
    ASSERT_EQ(none.culled_triangles, 0);
    for (int m = 0; m < 3; ++m) {
      ContinuousCounters counters;
      ASSERT_EQ(pairs_by(kAccurateForSteps[m], start, end, &counters), expected) << n;
      culled[m] += counters.culled_triangles;
    }
    triangles += std::ssize(start.triangles);
    pairs += std::ssize(expected.vertex_face) + std::ssize(expected.edge_edge);
  }
  EXPECT_GT(pairs, scaled(200));
  for (const std::int64_t count : culled) EXPECT_GT(count, triangles / 5);
}

TEST(ContinuousCulling, FollowsNewSteps) {
  Random random(33);
  for (std::int64_t n = 0; n < scaled(30); ++n) {
    const Surface first = surfaces::waved_sheet(random);
    const TriangleMesh mesh = first.mesh();
    for (const CullingMethod method : kAccurateForSteps) {
      ContinuousCollisionFinder finder(mesh, first.positions, first.positions, moving_by(method));
      Surface start = first;
      for (int step = 0; step < 3; ++step) {
        const Positions end = step_from(start, 0.2 * step, random);
        finder.update(start.positions, end);
        ASSERT_EQ(finder.find_pairs(), pairs_by(CullingMethod::kBvh, start, end)) << n;
        ASSERT_EQ(finder.has_pairs(), !finder.find_pairs().empty());
        start.positions = end;
      }
    }
  }
}

TEST(ContinuousCulling, IsTheSameForAnyNumberOfThreads) {
  Random random(34);
  for (int n = 0; n < 5; ++n) {
    const Surface start = surfaces::waved_sheet(random);
    const Positions end = step_from(start, 0.3, random);
    for (const CullingMethod method : kAccurateForSteps) {
      test::same_for_any_threads([&] {
        ContinuousCounters counters;
        const ContinuousPairs pairs = pairs_by(method, start, end, &counters);
        return std::tuple(pairs, counters.culled_triangles, counters.node_pairs);
      });
    }
  }
}

// A square turned over within the step: embedded in a plane at both ends, and passing through itself between.
TEST(ContinuousCulling, SeesWhatHappensBetweenTheEnds) {
  Random random(35);
  const Surface start = surfaces::sheet(9, 9, random);
  Positions end = start.positions;
  for (Vec3& x : end) x[0] = 9 - x[0];
  ContinuousCounters at_rest, turned;
  for (const CullingMethod method : kAccurateForSteps) {
    EXPECT_TRUE(pairs_by(method, start, start.positions, &at_rest).empty());
    EXPECT_FALSE(pairs_by(method, start, end, &turned).empty());
  }
  EXPECT_EQ(at_rest.culled_triangles, std::ssize(kAccurateForSteps) * std::ssize(start.triangles));
  EXPECT_EQ(turned.culled_triangles, 0);
  ASSERT_NO_FATAL_FAILURE(expect_all_agree(start, end));
}

// Layers that lie through each other and change places.
TEST(ContinuousCulling, IsNotFooledByTheCounterexamples) {
  std::vector<Surface> examples = {surfaces::crossed_rectangles(), surfaces::crosswise_squares()};
  for (int turn = 0; turn < 90; turn += 30) examples.push_back(surfaces::overwound_sector(turn));
  std::int64_t missed[std::size(kPublished)] = {};
  for (const Surface& start : examples) {
    Positions end = start.positions;
    for (Vec3& x : end) x[2] = -x[2];
    ASSERT_NO_FATAL_FAILURE(expect_all_agree(start, end));
    const ContinuousPairs all = pairs_by(CullingMethod::kBvh, start, end);
    EXPECT_FALSE(all.empty());
    for (std::size_t m = 0; m < std::size(kPublished); ++m) {
      const ContinuousPairs found = pairs_by(kPublished[m], start, end);
      EXPECT_TRUE(
          std::includes(all.edge_edge.begin(), all.edge_edge.end(), found.edge_edge.begin(), found.edge_edge.end()));
      EXPECT_TRUE(std::includes(all.vertex_face.begin(), all.vertex_face.end(), found.vertex_face.begin(),
                                found.vertex_face.end()));
      missed[m] += std::ssize(all.edge_edge) - std::ssize(found.edge_edge);
    }
  }
  EXPECT_GT(missed[0], 0);
  EXPECT_GT(missed[2], 0);
}

}  // namespace

}  // namespace selvage
