#include "self_collision/continuous/star_separation.h"

#include "self_collision/surfaces.h"
#include "selvage/self_collision/continuous_collision.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

/// Trembles, waves and turns; so little that stars are worth measuring, or by however much.
Positions moved(const Surface& surface, bool is_nearly_rigid, Random& random) {
  constexpr double kStrengths[] = {0, 1e-6, 1e-4, 0.001, 0.01, 0.1, 1};
  const double strength = kStrengths[random.below(is_nearly_rigid ? 4 : 7)];
  Positions end = surfaces::jittered(surface, 0.1 * strength, random).positions;
  const Vec3 wave(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
  const double turn = (is_nearly_rigid ? 0.01 : 1.0) * random.within(-0.3, 0.3);
  for (Vec3& x : end) {
    x += strength * std::sin(wave.dot(x)) * Vec3(0.3, -0.2, 1);
    x = Vec3(x[0], std::cos(turn) * x[1] - std::sin(turn) * x[2], std::sin(turn) * x[1] + std::cos(turn) * x[2]);
  }
  return end;
}

ContinuousPairs pairs_by_hierarchy(const TriangleMesh& mesh, const Positions& start, const Positions& end) {
  SelfCollisionOptions options;
  options.method = CullingMethod::kBvh;
  return ContinuousCollisionFinder(mesh, start, end, options).find_pairs();
}

bool have_common_vertex(const TriangleMesh& mesh, const IndexPair& pair) {
  const auto &a = mesh.triangles()[pair.first], &b = mesh.triangles()[pair.second];
  return std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end();
}

/// Pairs of neighbours that open stars do not list.
std::set<IndexPair> culled_neighbours(const TriangleMesh& mesh, const StarSeparation& stars) {
  std::vector<IndexPair> listed;
  for (const Index v : stars.open()) stars.append_pairs(v, listed);
  const std::set<IndexPair> open(listed.begin(), listed.end());
  EXPECT_EQ(open.size(), listed.size()) << "a pair is listed twice";
  std::set<IndexPair> culled;
  for (Index a = 0; a < mesh.triangle_count(); ++a)
    for (Index b = a + 1; b < mesh.triangle_count(); ++b)
      if (have_common_vertex(mesh, {a, b}) && open.count({a, b}) + open.count({b, a}) == 0) culled.insert({a, b});
  return culled;
}

class SeparatedStarsOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, SeparatedStarsOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

// A kept finder knows its stars from the second step on.
TEST_P(SeparatedStarsOf, ChangeNoAnswer) {
  Random random(71);
  for (std::int64_t n = 0; n < scaled(8); ++n) {
    Surface surface = GetParam().make(random);
    if (n % 4 == 0) surface = surfaces::snapped(surface, 3);
    const TriangleMesh mesh = surface.mesh();
    ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
    for (int step = 0; step < 12; ++step) {
      const Positions end = moved(surface, step % 4 != 3, random);
      finder.update(surface.positions, end);
      const ContinuousPairs expected = pairs_by_hierarchy(mesh, surface.positions, end);
      ASSERT_EQ(finder.find_pairs(), expected) << n << ", step " << step;
      ASSERT_EQ(finder.has_pairs(), !expected.empty());
      surface.positions = end;
    }
  }
}

// What meets during a step is never of two triangles of a separated star.
TEST_P(SeparatedStarsOf, CullNothingThatMeets) {
  Random random(72);
  for (std::int64_t n = 0; n < scaled(8); ++n) {
    Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    StarSeparation stars(mesh);
    for (int step = 0; step < 6; ++step) {
      const Positions end = moved(surface, random.below(2) == 0, random);
      stars.place(surface.positions, end);
      const std::set<IndexPair> culled = culled_neighbours(mesh, stars);
      const auto is_culled = [&](Index a, Index b) { return culled.contains({std::min(a, b), std::max(a, b)}); };
      const ContinuousPairs pairs = pairs_by_hierarchy(mesh, surface.positions, end);
      for (const VertexFacePair& pair : pairs.vertex_face)
        for (const Index t : mesh.vertex_triangles(pair.vertex)) ASSERT_FALSE(is_culled(t, pair.face));
      for (const EdgeEdgePair& pair : pairs.edge_edge)
        for (const Index t : mesh.edge_triangles(pair.first))
          for (const Index u : mesh.edge_triangles(pair.second)) ASSERT_FALSE(is_culled(t, u));
      surface.positions = end;
    }
  }
}

Surface wide_sheet() {
  Random random(73);
  return surfaces::jittered(surfaces::sheet(20, 20, random), 0.1, random);
}

TEST(StarSeparation, CullMostPairsOfAKeptFinder) {
  Surface sheet = wide_sheet();
  const TriangleMesh mesh = sheet.mesh();
  ContinuousCollisionFinder finder(mesh, sheet.positions, sheet.positions);
  Random random(75);
  for (int step = 0; step < 5; ++step) {
    const Positions end = moved(sheet, true, random);
    finder.update(sheet.positions, end);
    ContinuousCounters kept, fresh;
    finder.find_pairs(&kept);
    SelfCollisionOptions options;
    options.method = CullingMethod::kBvh;
    ContinuousCollisionFinder(mesh, sheet.positions, end, options).find_pairs(&fresh);
    EXPECT_LT(kept.box_pairs, fresh.box_pairs / 2);
    sheet.positions = end;
  }
}

TEST(StarSeparation, AreMeasuredOnceHoweverFarTheyAreTurned) {
  Surface sheet = wide_sheet();
  const TriangleMesh mesh = sheet.mesh();
  StarSeparation stars(mesh);
  for (int step = 0; step < 100; ++step) {
    const double turn = 0.01 * step;
    Positions next = sheet.positions;
    for (Vec3& x : next)
      x = Vec3(std::cos(turn) * x[0] - std::sin(turn) * x[2] + 3 * step, x[1],
               std::sin(turn) * x[0] + std::cos(turn) * x[2]);
    stars.place(next, next);
    EXPECT_EQ(stars.measured_count(), step == 0 ? stars.count() : 0);
    EXPECT_TRUE(stars.open().empty());
  }
}

TEST(StarSeparation, AreMeasuredEverMoreSeldomWhereThatDoesNotHelp) {
  Surface sheet = wide_sheet();
  const TriangleMesh mesh = sheet.mesh();
  StarSeparation stars(mesh);
  Positions flung = sheet.positions;
  constexpr Index kMiddle = 10 * 21 + 10;
  flung[kMiddle] += Vec3(-50, -50, 0);
  std::int64_t measured = 0;
  for (int step = 0; step < 1000; ++step) {
    stars.place(sheet.positions, flung);
    ASSERT_TRUE(stars.is_open(kMiddle));
    if (step > 0) measured += stars.measured_count();
  }
  EXPECT_GT(measured, 0);
  EXPECT_LT(measured, 9 * 1000 / 20);
  stars.place(sheet.positions, sheet.positions);
  for (int step = 0; step < 64; ++step) stars.place(sheet.positions, sheet.positions);
  EXPECT_TRUE(stars.open().empty());
}

TEST(StarSeparation, AreTheSameForAnyNumberOfThreads) {
  Surface sheet = wide_sheet();
  const TriangleMesh mesh = sheet.mesh();
  StarSeparation many(mesh), one(mesh);
  Random random(74);
  std::size_t open = 0;
  for (int step = 0; step < 10; ++step) {
    const Positions end = moved(sheet, false, random);
    many.place(sheet.positions, end);
    test::with_threads(1, [&] { one.place(sheet.positions, end); });
    ASSERT_TRUE(std::equal(many.open().begin(), many.open().end(), one.open().begin(), one.open().end()));
    open += many.open().size();
    sheet.positions = end;
  }
  EXPECT_GT(open, 0);
}

// A triangle may collapse within the reach of its star. Axes that turn with it mean nothing then.
TEST(StarSeparation, AreNotFooledByAThinTriangle) {
  const TriangleMesh mesh(4, {{0, 1, 2}, {0, 2, 3}});
  Random random(76);
  for (std::int64_t n = 0; n < scaled(400); ++n) {
    const double turn = random.within(-3, 3), tilt = random.within(-3, 3), far = n % 2 == 0 ? 0 : 0x1p20;
    const auto placed = [&](double height, const Vec3& tip) {
      Positions positions = {{0, 0, 0}, {10, height, 0}, {1, 0, 0}, tip};
      for (Vec3& x : positions) {
        x = Vec3(x[0], std::cos(tilt) * x[1] - std::sin(tilt) * x[2], std::sin(tilt) * x[1] + std::cos(tilt) * x[2]);
        x = Vec3(std::cos(turn) * x[0] - std::sin(turn) * x[1], std::sin(turn) * x[0] + std::cos(turn) * x[1], x[2]);
        x += Vec3(far, -far, far);
      }
      return positions;
    };
    const Vec3 tip(0.5, -1, 0.1);
    const double thin = std::pow(10, random.within(-18, -6));
    const Positions wide = placed(0.2, tip), start = placed(thin, tip), end = placed(-thin, Vec3(0.5, 0, -0.1));
    ContinuousCollisionFinder finder(mesh, wide, wide);
    finder.update(wide, wide);
    ASSERT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, wide, wide)) << n;
    finder.update(start, start);
    ASSERT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, start, start)) << n;
    finder.update(start, end);
    ASSERT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, start, end)) << n;
  }
}

// Two wings that shut like a book, slowly at first.
TEST(StarSeparation, OpenBeforeAFoldShuts) {
  const TriangleMesh mesh(4, {{0, 1, 2}, {1, 0, 3}});
  const auto book = [](double angle) {
    return Positions{{0, 0, 0}, {0, 1, 0}, {1, 0.5, 0}, {std::cos(angle), 0.6, std::sin(angle)}};
  };
  ContinuousCollisionFinder finder(mesh, book(3), book(3));
  double angle = 3;
  for (; angle > 0.1; angle -= 0.01) {
    finder.update(book(angle), book(angle - 0.01));
    ASSERT_EQ(finder.find_pairs(), pairs_by_hierarchy(mesh, book(angle), book(angle - 0.01))) << angle;
  }
  finder.update(book(angle), book(-0.1));
  EXPECT_EQ(finder.find_pairs().edge_edge.size() + finder.find_pairs().vertex_face.size(), 1);
}

}  // namespace
}  // namespace selvage
