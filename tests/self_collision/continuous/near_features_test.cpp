#include "self_collision/continuous/near_features.h"

#include "self_collision/surfaces.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace selvage {
namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using test::seed;
using Positions = std::vector<Vec3>;

/// How the end of a step differs from its start, or from the end of a try before.
enum class Move { kNone, kTremble, kOne, kSome, kAll, kTurn, kMirror, kJump, kCount };

void move(Move how, Positions& positions, Random& random) {
  const auto count = static_cast<Index>(positions.size());
  switch (how) {
    case Move::kTremble:
      for (Vec3& x : positions) x += random.vector(1e-3);
      break;
    case Move::kOne:
      positions[random.below(count)] += random.vector(random.below(2) == 0 ? 0.3 : 3);
      break;
    case Move::kSome:
      for (Index i = 0; i <= count / 40; ++i) positions[random.below(count)] += random.vector(0.2);
      break;
    case Move::kAll:
      for (Vec3& x : positions) x += random.vector(0.1);
      break;
    case Move::kTurn: {
      const double turn = random.within(-0.02, 0.02);
      for (Vec3& x : positions)
        x = Vec3(x[0], std::cos(turn) * x[1] - std::sin(turn) * x[2], std::sin(turn) * x[1] + std::cos(turn) * x[2]);
      break;
    }
    case Move::kMirror:
      for (Vec3& x : positions) x[2] = -x[2];
      break;
    case Move::kJump: {
      const Vec3 jump = random.vector(100);
      for (Vec3& x : positions) x += jump;
      break;
    }
    default:
      break;
  }
}

/// Mostly moves after which lists hold.
Move any_move(Random& random) {
  if (random.below(6) == 0) return static_cast<Move>(random.below(static_cast<std::uint64_t>(Move::kCount)));
  constexpr Move kLittle[] = {Move::kNone, Move::kTremble, Move::kOne, Move::kSome};
  return kLittle[random.below(4)];
}

ContinuousPairs pairs_by_hierarchy(const TriangleMesh& mesh, const Positions& start, const Positions& end) {
  SelfCollisionOptions options;
  options.method = CullingMethod::kBvh;
  return ContinuousCollisionFinder(mesh, start, end, options).find_pairs();
}

/// What a kept finder finds over steps, each of which is asked for up to three times with another end; and how often it
/// compared no nodes.
struct Found {
  std::vector<ContinuousPairs> pairs;
  int from_list = 0;

  bool operator==(const Found& other) const { return pairs == other.pairs && from_list == other.from_list; }
};

Found find_over_steps(Surface surface, Random random, int steps, bool compares) {
  const TriangleMesh mesh = surface.mesh();
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
  Found found;
  for (int step = 0; step < steps; ++step) {
    Positions end = surface.positions;
    for (std::uint64_t tries = 1 + random.below(3); tries > 0; --tries) {
      move(any_move(random), end, random);
      finder.update(surface.positions, end);
      ContinuousCounters counters;
      found.pairs.push_back(finder.find_pairs(&counters));
      found.from_list += counters.node_pairs == 0;
      if (!compares) continue;
      EXPECT_EQ(found.pairs.back(), pairs_by_hierarchy(mesh, surface.positions, end)) << "step " << step;
      EXPECT_EQ(finder.has_pairs(), !found.pairs.back().empty());
    }
    surface.positions = end;
  }
  return found;
}

/// The same where vertices go on as in the step before but for a little, and some turn aside.
/// @param turn_every  all turn back once in so many steps
Found find_while_going_on(Surface surface, Random random, int steps, bool compares, std::uint64_t turn_every) {
  const TriangleMesh mesh = surface.mesh();
  const auto count = static_cast<Index>(surface.positions.size());
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
  Positions ways(count);
  const double twist = random.within(-0.01, 0.01);
  for (Index v = 0; v < count; ++v) {
    const Vec3& x = surface.positions[v];
    ways[v] = Vec3(0.02, 0.01, 0) + twist * x[0] * Vec3(0, -x[2], x[1]) + random.vector(1e-3);
  }
  Found found;
  for (int step = 0; step < steps; ++step) {
    if (random.below(3) == 0) ways[random.below(count)] += random.vector(0.05);
    if (random.below(turn_every) == 0)
      for (Vec3& way : ways) way = Vec3(way[0], way[1], -way[2]);
    for (std::uint64_t tries = 1 + random.below(2); tries > 0; --tries) {
      Positions end = surface.positions;
      for (Index v = 0; v < count; ++v) end[v] += ways[v] + random.vector(1e-4);
      finder.update(surface.positions, end);
      ContinuousCounters counters;
      found.pairs.push_back(finder.find_pairs(&counters));
      found.from_list += counters.node_pairs == 0;
      if (compares) {
        EXPECT_EQ(found.pairs.back(), pairs_by_hierarchy(mesh, surface.positions, end)) << "step " << step;
      }
      if (tries == 1) surface.positions = end;
    }
  }
  return found;
}

/// Sheets one over the other, so near that some of what moves meets.
Surface two_sheets(Random& random) {
  Surface above = surfaces::sheet(16, 16, random);
  for (Vec3& x : above.positions) x += Vec3(0.3, 0.2, 0.12);
  return surfaces::jittered(surfaces::together(surfaces::sheet(16, 16, random), above), 0.04, random);
}

class NearFeaturesOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, NearFeaturesOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(NearFeaturesOf, ChangeNoAnswer) {
  Random random(seed(81));
  for (std::int64_t n = 0; n < scaled(6); ++n) {
    Surface surface = GetParam().make(random);
    if (n % 3 == 0) surface = surfaces::snapped(surface, 3);
    find_over_steps(surface, Random(random.bits()), 20, true);
  }
}

TEST(NearFeatures, ChangeNoAnswerBetweenSheets) {
  Random random(seed(82));
  int from_list = 0;
  std::size_t met = 0;
  for (std::int64_t n = 0; n < scaled(4); ++n) {
    const Found found = find_over_steps(two_sheets(random), Random(random.bits()), 30, true);
    from_list += found.from_list;
    for (const ContinuousPairs& pairs : found.pairs) met += pairs.vertex_face.size() + pairs.edge_edge.size();
  }
  EXPECT_GT(from_list, scaled(40));
  EXPECT_GT(met, static_cast<std::size_t>(scaled(400)));
}

TEST_P(NearFeaturesOf, ChangeNoAnswerWhileAllGoesOn) {
  Random random(seed(86));
  for (std::int64_t n = 0; n < scaled(3); ++n)
    find_while_going_on(GetParam().make(random), Random(random.bits()), 20, true, 20);
}

TEST(NearFeatures, LastWhileAllGoesOn) {
  Random random(seed(87));
  int from_list = 0, asked = 0;
  std::size_t met = 0;
  for (std::int64_t n = 0; n < scaled(4, 4); ++n) {  // in one alone lists may not pay
    const Found found = find_while_going_on(two_sheets(random), Random(random.bits()), 40, true, 1000);
    from_list += found.from_list;
    asked += static_cast<int>(found.pairs.size());
    for (const ContinuousPairs& pairs : found.pairs) met += pairs.vertex_face.size() + pairs.edge_edge.size();
  }
  EXPECT_GT(8 * from_list, asked);
  EXPECT_GT(met, static_cast<std::size_t>(scaled(400)));
}

TEST(NearFeatures, AreTheSameForAnyNumberOfThreads) {
  Random random(seed(83));
  const Surface surface = two_sheets(random);
  const std::uint64_t bits = random.bits();
  test::same_for_any_threads([&] { return find_over_steps(surface, Random(bits), 15, false); });
  test::same_for_any_threads([&] { return find_while_going_on(surface, Random(bits), 15, false, 20); });
}

// Where nothing moves, a kept finder compares no nodes, and what it tests is what lies near.
TEST(NearFeatures, AreAllThatIsTestedWhereNothingMoves) {
  Random random(seed(84));
  const Surface surface = two_sheets(random);
  const TriangleMesh mesh = surface.mesh();
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
  for (int step = 0; step < 6; ++step) {
    finder.update(surface.positions, surface.positions);
    ContinuousCounters counters;
    EXPECT_EQ(finder.find_pairs(&counters), pairs_by_hierarchy(mesh, surface.positions, surface.positions));
    EXPECT_EQ(counters.node_pairs, 0);
  }
}

// Where nothing moves for longer, nothing is tested, until something does.
TEST(NearFeatures, AreNotTestedWhereNothingMovesForLonger) {
  Random random(seed(89));
  for (int trial = 0; trial < scaled(40, 4); ++trial) {
    const Surface surface = two_sheets(random);
    const TriangleMesh mesh = surface.mesh();
    Positions positions = surface.positions;
    ContinuousCollisionFinder finder(mesh, positions, positions);
    const auto expect_answer = [&](const Positions& end) {
      const ContinuousPairs expected = pairs_by_hierarchy(mesh, positions, end);
      EXPECT_EQ(finder.find_pairs(), expected);
      EXPECT_EQ(finder.has_pairs(), !expected.vertex_face.empty() || !expected.edge_edge.empty());
    };
    for (int turn = 0; turn < 4; ++turn) {
      for (int step = 0; step < 4; ++step) {
        finder.update(positions, positions);
        expect_answer(positions);
        ContinuousCounters counters;
        finder.find_pairs(&counters);
        if (step > 0) {
          EXPECT_EQ(counters.box_pairs + counters.node_pairs + counters.vertex_face_boxes + counters.exact_tests, 0);
        }
      }
      const auto v = static_cast<Index>(random.below(static_cast<Index>(positions.size())));
      Positions end = positions;
      end[v] += random.vector(0.5);
      if (turn % 2 == 0) {
        finder.update(positions, end);
        expect_answer(end);
        positions = end;
      } else {
        finder.move_ends(std::array{v}, end);
        expect_answer(end);
      }
    }
    finder.update(positions, positions);
    finder.update(positions, positions);
    finder.rebuild(surface.positions, positions);
    EXPECT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, surface.positions, positions));
  }
}

// No step has shown yet that stars pay.
TEST(NearFeatures, ServeWhatRestsFromTheFirstStepAndAreKeptOnlyWhereWanted) {
  Random random(seed(88));
  IndexedMesh sheet = make_cloth(1, 1, 0.05);
  for (Vec3& x : sheet.positions) x[2] = 0.05 * std::sin(9 * x[0]) * std::cos(7 * x[1]);
  IndexedMesh sheets = concatenate(std::array{sheet, sheet});
  const auto vertex_count = static_cast<Index>(sheets.positions.size());
  for (Index v = vertex_count / 2; v < vertex_count; ++v) sheets.positions[v] += Vec3(0.01, 0.02, 0.03);
  const TriangleMesh mesh(vertex_count, sheets.triangles);
  SelfCollisionOptions alone;
  alone.reuse = false;
  Positions start = sheets.positions;
  ContinuousCollisionFinder finder(mesh, start, start);
  ContinuousCollisionFinder forgetful(mesh, start, start, alone);
  for (int step = 0; step < 20; ++step) {
    Positions end = start;
    for (Vec3& x : end) x += random.vector(1e-6);
    finder.update(start, end);
    forgetful.update(start, end);
    ContinuousCounters counters, counters_alone;
    const ContinuousPairs pairs = finder.find_pairs(&counters);
    EXPECT_EQ(pairs, pairs_by_hierarchy(mesh, start, end));
    EXPECT_EQ(pairs, forgetful.find_pairs(&counters_alone));
    EXPECT_EQ(counters.node_pairs + counters.self_node_pairs, 0) << step;
    EXPECT_GT(counters_alone.node_pairs + counters_alone.self_node_pairs, 0) << step;
    start = end;
  }
}

TEST(NearFeatures, RefuseWhatAFinderRefuses) {
  Random random(seed(85));
  const Surface surface = two_sheets(random);
  const TriangleMesh mesh = surface.mesh();
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
  for (int step = 0; step < 4; ++step) finder.update(surface.positions, surface.positions);
  Positions broken = surface.positions;
  broken[5][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_ANY_THROW(finder.update(surface.positions, broken));
  EXPECT_ANY_THROW(finder.update(broken, surface.positions));
  broken.pop_back();
  EXPECT_ANY_THROW(finder.update(surface.positions, broken));
  Positions moved = surface.positions;
  for (Vec3& x : moved) x[2] *= 0.5;
  finder.update(surface.positions, moved);
  EXPECT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, surface.positions, moved));
}

}  // namespace
}  // namespace selvage
