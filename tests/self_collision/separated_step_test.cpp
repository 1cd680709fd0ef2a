#include "self_collision/surfaces.h"
#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"
#include "selvage/self_collision/continuous_collision.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

static_assert(
    !std::is_constructible_v<ContinuousCollisionFinder, TriangleMesh, std::span<const Vec3>, std::span<const Vec3>>);
static_assert(std::is_constructible_v<ContinuousCollisionFinder, const TriangleMesh&, std::span<const Vec3>,
                                      std::span<const Vec3>>);

/// The smallest difference between the distance of a pair and its thickness, over all pairs one by one at one time.
double smallest_clearance(const TriangleMesh& mesh, const Positions& x, const std::vector<double>& thickness) {
  double smallest = HUGE_VAL;
  surfaces::visit_vertex_faces(mesh, [&](Index v, Index f) {
    const auto& t = mesh.triangles()[f];
    const double apart = std::sqrt(closest_point_on_triangle(x[v], x[t[0]], x[t[1]], x[t[2]]).squared_distance);
    smallest = std::min(smallest, apart - thickness[v] - surfaces::thickest(thickness, t));
  });
  surfaces::visit_edge_pairs(mesh, [&](Index e, Index f) {
    const auto &a = mesh.edges()[e], &b = mesh.edges()[f];
    const double apart = std::sqrt(squared_distance(std::array{x[a[0]], x[a[1]]}, std::array{x[b[0]], x[b[1]]}));
    smallest = std::min(smallest, apart - surfaces::thickest(thickness, a) - surfaces::thickest(thickness, b));
  });
  return smallest;
}

Positions at_time(const Positions& t0, const Positions& t1, double time) {
  Positions x(t0.size());
  for (std::size_t v = 0; v < x.size(); ++v) x[v] = (1 - time) * t0[v] + time * t1[v];
  return x;
}

/// Two sheets of which one falls through the other, both waved.
struct FallingSheet {
  Surface surface;
  Positions end;

  explicit FallingSheet(Random& random) {
    const Surface below = surfaces::jittered(surfaces::sheet(3, 3, random), 0.1, random);
    Surface above = surfaces::jittered(surfaces::sheet(3, 3, random), 0.1, random);
    for (Vec3& x : above.positions) x += Vec3(0.3, 0.2, 1);
    surface = surfaces::together(below, above);
    end = surfaces::jittered(surface, 0.2, random).positions;
    for (std::size_t v = end.size() / 2; v < end.size(); ++v) end[v] -= Vec3(0.2, 0, random.within(0.5, 2));
  }
};

TEST(SeparatedStep, KeepsPairsApartAtAllSampledTimesAndEndsWhereOneIsNear) {
  Random random(51);
  std::int64_t stopped = 0, whole = 0;
  for (std::int64_t n = 0; n < scaled(30, 10); ++n) {
    const FallingSheet fall(random);
    const TriangleMesh mesh = fall.surface.mesh();
    SelfCollisionOptions options;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      options.thickness.push_back(n % 3 == 0 ? 0.02 : random.within(0, 0.1));
    const ContinuousCollisionFinder finder(mesh, fall.surface.positions, fall.end, options);
    const double step = finder.find_separated_step();
    ASSERT_LE(step, finder.find_free_step());
    for (int k = 0; k < 100; ++k)
      ASSERT_GE(smallest_clearance(mesh, at_time(fall.surface.positions, fall.end, step * k / 100), options.thickness),
                -1e-12)
          << n << " " << k;
    ++(step < 1 ? stopped : whole);
    if (step == 1) continue;
    // No vertex moves by more than 4 in the whole step.
    ASSERT_LE(smallest_clearance(mesh, at_time(fall.surface.positions, fall.end, step), options.thickness),
              8 * 0x1p-20 + 0.2 * 0x1p-20);
  }
  EXPECT_GT(stopped, whole / 4);
  EXPECT_GT(stopped + whole, 0);
}

class SeparatedStepOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, SeparatedStepOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(SeparatedStepOf, IsTheFreeStepWithoutThickness) {
  Random random(52);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    const Positions end = surfaces::jittered(surface, n % 2 == 0 ? 0.05 : 1, random).positions;
    const ContinuousCollisionFinder thin(mesh, surface.positions, end);
    ASSERT_EQ(thin.find_separated_step(), thin.find_free_step());
    SelfCollisionOptions options;
    options.thickness.assign(mesh.vertex_count(), 0.02);
    const ContinuousCollisionFinder thick(mesh, surface.positions, end, options);
    ASSERT_LE(thick.find_separated_step(), thin.find_free_step());
    if (smallest_clearance(mesh, surface.positions, options.thickness) < -1e-12) {
      ASSERT_EQ(thick.find_separated_step(), 0);
    }
  }
}

TEST(SeparatedStep, OfATriangleThatFallsOnAnother) {
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const Positions start{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, 2}, {2, 1, 2}};
  Positions end = start;
  for (int v = 3; v < 6; ++v) end[v] -= Vec3(0, 0, 2);
  SelfCollisionOptions options;
  options.thickness = {0, 0, 0.125, 0.125, 0, 0};
  const ContinuousCollisionFinder finder(mesh, start, end, options);
  EXPECT_NEAR(finder.find_separated_step(), 0.375, 0x1p-19);
  EXPECT_LE(finder.find_separated_step(), 0.375);
  EXPECT_NEAR(finder.find_free_step(), 0.5, 1e-6);
  // A thickness far below the rounding of coordinates does not hide the impact.
  options.thickness.assign(6, 1e-300);
  const ContinuousCollisionFinder thin(mesh, start, end, options);
  EXPECT_LE(thin.find_separated_step(), thin.find_free_step());
  EXPECT_NEAR(thin.find_separated_step(), 0.5, 1e-5);
  EXPECT_THROW(finder.find_separated_step({{{6, 0}}, {}}), Error);
}

TEST(SeparatedStep, IsTheSameForAnyNumberOfThreads) {
  Random random(53);
  const Surface sheet = surfaces::jittered(surfaces::sheet(20, 20, random), 0.2, random);
  const TriangleMesh mesh = sheet.mesh();
  Positions end = sheet.positions;
  for (Vec3& x : end) x = Vec3(std::abs(x[0] - 8.3), x[1], x[2] + 0.01 * x[0]);
  SelfCollisionOptions options;
  options.thickness.assign(mesh.vertex_count(), 0.01);
  const ContinuousCollisionFinder finder(mesh, sheet.positions, end, options);
  for (int n = 0; n < 5; ++n) {
    const double step = test::same_for_any_threads([&] { return finder.find_separated_step(); });
    EXPECT_GT(step, 0);
    EXPECT_LT(step, 1);
  }
}

}  // namespace
}  // namespace selvage
