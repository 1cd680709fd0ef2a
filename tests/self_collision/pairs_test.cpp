#include "self_collision/oracle.h"
#include "selvage/core/error.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"
#include "threads.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>

namespace selvage {

void PrintTo(const TrianglePair& pair, std::ostream* out) {
  *out << pair.first << "-" << pair.second << " contact " << static_cast<int>(pair.contact);
}

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Pairs = std::vector<TrianglePair>;

static_assert(!std::is_constructible_v<SelfCollisionFinder, TriangleMesh, std::span<const Vec3>>);
static_assert(std::is_constructible_v<SelfCollisionFinder, const TriangleMesh&, std::span<const Vec3>>);

SelfCollisionOptions with_adjacent() {
  SelfCollisionOptions options;
  options.include_adjacent = true;
  return options;
}

class PairsOf : public testing::TestWithParam<surfaces::Family> {
 protected:
  /// A surface of the family, now and then with coordinates that are no small integers.
  Surface make(Random& random, std::int64_t number) const {
    const Surface surface = GetParam().make(random);
    return number % 8 == 7 ? surface : surfaces::snapped(surface, number % 2 == 0 ? 8 : 2);
  }
};
INSTANTIATE_TEST_SUITE_P(All, PairsOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

// 18 families: more than 2,000 surfaces.
TEST_P(PairsOf, AreThoseOfTheOracle) {
  Random random(1);
  for (std::int64_t n = 0; n < scaled(120); ++n) {
    const Surface surface = make(random, n);
    const TriangleMesh mesh = surface.mesh();
    const Pairs expected = oracle::meeting_pairs(surface, false);
    const SelfCollisionFinder finder(mesh, surface.positions);
    ASSERT_EQ(finder.find_pairs(), expected) << n;
    ASSERT_EQ(finder.has_pairs(), !expected.empty()) << n;
    const SelfCollisionFinder adjacent(mesh, surface.positions, with_adjacent());
    ASSERT_EQ(adjacent.find_pairs(), oracle::meeting_pairs(surface, true)) << n;
  }
}

std::array<Vec3, 3> corners(const Surface& surface, Index triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  return {surface.positions[a], surface.positions[b], surface.positions[c]};
}

TEST_P(PairsOf, HaveSegmentsWhereTheyCrossOrTouch) {
  Random random(9);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = make(random, n), other_surface = make(random, n);
    const TriangleMesh mesh = surface.mesh(), other_mesh = other_surface.mesh();
    const SelfCollisionFinder finder(mesh, surface.positions, with_adjacent()),
        other(other_mesh, other_surface.positions);
    const auto expect_segments = [](const Surface& a, const Surface& b, const Pairs& pairs,
                                    const std::vector<CommonSegment>& segments) {
      ASSERT_EQ(segments.size(), pairs.size());
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        EXPECT_EQ(segments[i].has_value(), pairs[i].contact != TriangleContact::kCoplanarOverlap);
        EXPECT_TRUE(segments[i] == intersection_segment(corners(a, pairs[i].first), corners(b, pairs[i].second)));
      }
    };
    const Pairs own = finder.find_pairs(), both = finder.find_pairs_with(other);
    expect_segments(surface, surface, own, finder.find_segments(own));
    expect_segments(surface, other_surface, both, finder.find_segments_with(other, both));
    const std::vector<TrianglePair> outside{{0, mesh.triangle_count(), TriangleContact::kTouching}};
    EXPECT_THROW(finder.find_segments(outside), Error);
  }
}

TEST_P(PairsOf, OfASubsetAreThoseWithATriangleInIt) {
  Random random(2);
  for (std::int64_t n = 0; n < scaled(30); ++n) {
    const Surface surface = make(random, n);
    const TriangleMesh mesh = surface.mesh();
    for (const bool adjacent : {false, true}) {
      const SelfCollisionFinder finder(mesh, surface.positions, adjacent ? with_adjacent() : SelfCollisionOptions());
      std::vector<Index> subset;
      for (Index t = mesh.triangle_count(); t-- > 0;)
        if (random.below(3) == 0) subset.push_back(t);
      Pairs expected = finder.find_pairs();
      const auto chosen = [&](Index t) { return std::count(subset.begin(), subset.end(), t) > 0; };
      std::erase_if(expected, [&](const TrianglePair& p) { return !chosen(p.first) && !chosen(p.second); });
      ASSERT_EQ(finder.find_pairs_of(subset), expected) << n;
    }
  }
}

TEST_P(PairsOf, TwoSurfacesAreThoseOfTheOracle) {
  Random random(3);
  for (std::int64_t n = 0; n < scaled(20); ++n) {
    const Surface a = make(random, n), other = surfaces::families()[random.below(17)].make(random);
    // Far away from the other's middle, and of another size: the two have different box units.
    Surface b = surfaces::snapped(other, 4);
    for (Vec3& x : b.positions) x = x * (n % 3 == 0 ? 64 : 1) + Vec3(n % 2, 0, 0);
    const TriangleMesh mesh_a = a.mesh(), mesh_b = b.mesh();
    const SelfCollisionFinder finder_a(mesh_a, a.positions), finder_b(mesh_b, b.positions);
    ASSERT_EQ(finder_a.find_pairs_with(finder_b), oracle::meeting_pairs(a, b)) << n;
    ASSERT_EQ(finder_b.find_pairs_with(finder_a), oracle::meeting_pairs(b, a)) << n;
  }
}

TEST_P(PairsOf, AreTheSameAfterARefitAndAfterARebuild) {
  Random random(4);
  for (std::int64_t n = 0; n < scaled(20); ++n) {
    const Surface surface = make(random, n);
    const TriangleMesh mesh = surface.mesh();
    SelfCollisionFinder finder(mesh, surface.positions);
    Surface moved = surface;
    for (int step = 0; step < 4; ++step) {
      moved = surfaces::snapped(surfaces::jittered(moved, step == 2 ? 5 : 0.3, random), 6);
      finder.update(moved.positions);
      const Pairs expected = SelfCollisionFinder(mesh, moved.positions).find_pairs();
      ASSERT_EQ(finder.find_pairs(), expected) << n;
      finder.rebuild(moved.positions);
      ASSERT_EQ(finder.find_pairs(), expected) << n;
    }
    finder.update(surface.positions);
    ASSERT_EQ(finder.find_pairs(), oracle::meeting_pairs(surface, false)) << n;
  }
}

TEST_P(PairsOf, DoNotDependOnPlaceAndSize) {
  Random random(5);
  for (std::int64_t n = 0; n < scaled(5); ++n) {
    Surface surface = surfaces::snapped(GetParam().make(random), 8);
    const TriangleMesh mesh = surface.mesh();
    const Pairs expected = SelfCollisionFinder(mesh, surface.positions, with_adjacent()).find_pairs();
    for (const double scale : {1.0, 0x1p1010, 0x1p-1050, 0x1p40, 0x1p-200})
      for (const double shift : {0.0, 0x1p20}) {
        Surface moved = surface;
        for (Vec3& x : moved.positions) x = (x + Vec3(shift, -shift, shift / 2)) * std::min(scale, 0x1p1000);
        ASSERT_EQ(SelfCollisionFinder(mesh, moved.positions, with_adjacent()).find_pairs(), expected)
            << scale << " " << shift;
      }
  }
}

IndexedMesh large_cloth(double amount) {
  IndexedMesh cloth = make_cloth(4, 4, 0.04);
  Random random(6);
  for (Vec3& x : cloth.positions)
    x += Vec3(random.within(-amount, amount), random.within(-amount, amount), random.within(-amount, amount));
  return cloth;
}

TEST(Pairs, AreTheSameForAnyNumberOfThreads) {
  const IndexedMesh cloth = large_cloth(0.05);
  const TriangleMesh mesh(static_cast<Index>(cloth.positions.size()), cloth.triangles);
  SelfCollisionCounters counters;
  const auto [pairs, node_pairs, exact_tests] = test::same_for_any_threads([&] {
    counters = {};
    const SelfCollisionFinder finder(mesh, cloth.positions, with_adjacent());
    const Pairs found = finder.find_pairs(&counters);
    EXPECT_TRUE(finder.has_pairs());
    return std::tuple(found, counters.node_pairs, counters.exact_tests);
  });
  EXPECT_GT(pairs.size(), 10000u);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
  EXPECT_GT(node_pairs, 0);
  EXPECT_GT(counters.box_pairs, counters.adjacent_pairs);
}

// Nothing but few tests in exact arithmetic makes a flat or gently waved surface fast.
TEST(Pairs, NeighboursOnASmoothSurfaceAreToldApartInSinglePrecision) {
  IndexedMesh cloth = make_cloth(4, 4, 0.04);
  for (Vec3& x : cloth.positions) x[2] = 0.3 * std::sin(3 * x[0]) * std::cos(2 * x[1]);
  const TriangleMesh mesh(static_cast<Index>(cloth.positions.size()), cloth.triangles);
  SelfCollisionCounters counters;
  SelfCollisionOptions options = with_adjacent();
  options.method = CullingMethod::kBvh;  // culling would not even look at them
  const SelfCollisionFinder finder(mesh, cloth.positions, options);
  EXPECT_TRUE(finder.find_pairs(&counters).empty());
  EXPECT_FALSE(finder.has_pairs());
  EXPECT_GT(counters.adjacent_pairs, 5 * mesh.triangle_count());
  EXPECT_LT(counters.exact_tests, mesh.triangle_count());
}

TEST(Pairs, YesOrNoStopsEarly) {
  const IndexedMesh cloth = large_cloth(0.05);
  const TriangleMesh mesh(static_cast<Index>(cloth.positions.size()), cloth.triangles);
  const SelfCollisionFinder finder(mesh, cloth.positions);
  SelfCollisionCounters all, some;
  finder.find_pairs(&all);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(finder.has_pairs(&some));
  EXPECT_LT(20 * some.node_pairs, all.node_pairs);
}

TEST(Pairs, BadInputIsRefused) {
  Random random(7);
  Surface surface = surfaces::sheet(2, 2, random);
  const TriangleMesh mesh = surface.mesh();
  SelfCollisionFinder finder(mesh, surface.positions);
  EXPECT_THROW(finder.update(std::span(surface.positions).first(3)), Error);
  EXPECT_THROW(finder.find_pairs_of(std::vector<Index>{8}), Error);
  EXPECT_THROW(finder.find_pairs_of(std::vector<Index>{-1}), Error);
  EXPECT_THROW(finder.find_pairs_of(std::vector<Index>{1, 2, 1}), Error);
  EXPECT_TRUE(finder.find_pairs_of({}).empty());
  surface.positions[5][1] = std::nan("");
  EXPECT_THROW(SelfCollisionFinder(mesh, surface.positions), Error);
  EXPECT_THROW(finder.update(surface.positions), Error);
  EXPECT_THROW(culling_method("cones"), Error);
  EXPECT_EQ(culling_method("bvh"), CullingMethod::kBvh);
}

}  // namespace
}  // namespace selvage
