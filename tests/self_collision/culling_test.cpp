#include "self_collision/culling/enhanced_dual_cone.h"
#include "self_collision/culling_surfaces.h"
#include "self_collision/prepared_surface.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/shapes/sequences.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;

class CullingOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, CullingOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(CullingOf, ChangesNoAnswer) {
  Random random(11);
  for (std::int64_t n = 0; n < scaled(60); ++n) {
    const Surface surface = GetParam().make(random);
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(n % 4 == 0 ? surfaces::snapped(surface, 3) : surface)) << n;
  }
}

TEST(Culling, ChangesNoAnswerOnCombs) {
  for (const double lean : {0.0, 0.3, 0.8, 1.0, 1.4}) {
    const Surface surface = surfaces::comb(lean);
    EXPECT_EQ(pairs_by(CullingMethod::kBvh, surface).empty(), lean < 0.5) << lean;
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface)) << lean;
  }
}

TEST(Culling, ChangesNoAnswerOnWavedSheets) {
  Random random(12);
  SelfCollisionCounters counters[std::size(kAccurate)];
  std::int64_t triangles = 0;
  for (std::int64_t n = 0; n < scaled(200); ++n) {
    const Surface surface = surfaces::waved_sheet(random);
    triangles += std::ssize(surface.triangles);
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(n % 8 == 0 ? surfaces::snapped(surface, 4) : surface)) << n;
    for (std::size_t m = 0; m < std::size(kAccurate); ++m) pairs_by(kAccurate[m], surface, false, &counters[m]);
  }
  // Else nothing of the above means anything.
  for (const SelfCollisionCounters& counter : counters) EXPECT_GT(counter.culled_triangles, triangles / 4);
}

TEST(Culling, FollowsNewPoses) {
  Random random(13);
  for (std::int64_t n = 0; n < scaled(30); ++n) {
    const Surface first = surfaces::waved_sheet(random);
    const TriangleMesh mesh = first.mesh();
    for (const CullingMethod method : kAccurate) {
      SelfCollisionFinder finder(mesh, first.positions, by(method));
      for (int pose = 0; pose < 3; ++pose) {
        const Surface next = surfaces::jittered(first, 0.3 * pose, random);
        finder.update(next.positions);
        ASSERT_EQ(finder.find_pairs(), pairs_by(CullingMethod::kBvh, next)) << n;
        ASSERT_EQ(finder.has_pairs(), !finder.find_pairs().empty());
      }
    }
  }
}

// Where a sample of small pieces shows that little would be culled, no other piece is tested; else all that can be
// culled are.
TEST(Culling, IsAskedWhereItPays) {
  Random random(21);
  Surface flat = surfaces::sheet(160, 160, random), crumpled = flat;
  for (Vec3& x : crumpled.positions) x += Vec3(random.within(-2, 2), random.within(-2, 2), random.within(-2, 2));
  SelfCollisionCounters of_flat, of_crumpled, of_bvh;
  EXPECT_TRUE(pairs_by(CullingMethod::kAuto, flat, false, &of_flat).empty());
  EXPECT_EQ(of_flat.culled_triangles, std::ssize(flat.triangles));
  EXPECT_EQ(pairs_by(CullingMethod::kAuto, crumpled, false, &of_crumpled),
            pairs_by(CullingMethod::kBvh, crumpled, false, &of_bvh));
  EXPECT_EQ(of_crumpled.culled_nodes, 0);
  EXPECT_EQ(of_crumpled.node_pairs, of_bvh.node_pairs);
  // A sixth of it crumpled: the rest is culled.
  for (std::size_t v = 0; v < flat.positions.size() / 6; ++v) flat.positions[v] = crumpled.positions[v];
  SelfCollisionCounters of_both;
  EXPECT_EQ(pairs_by(CullingMethod::kAuto, flat, false, &of_both), pairs_by(CullingMethod::kBvh, flat));
  EXPECT_GT(of_both.culled_triangles, std::ssize(flat.triangles) / 2);
}

TEST(Culling, IsTheSameForAnyNumberOfThreads) {
  Random random(14);
  for (int n = 0; n < 5; ++n) {
    const Surface surface = surfaces::waved_sheet(random);
    for (const CullingMethod method : kAccurate) {
      test::same_for_any_threads([&] {
        SelfCollisionCounters counters;
        const Pairs pairs = pairs_by(method, surface, false, &counters);
        return std::tuple(pairs, counters.culled_triangles, counters.node_pairs);
      });
    }
  }
}

TEST(Culling, IsOffWhereThicknessCounts) {
  Surface surface = surfaces::together(surfaces::crossed_rectangles(), {});
  for (Vec3& x : surface.positions) x[2] = 0;
  for (std::size_t v = 0; v < surface.positions.size() / 2; ++v) surface.positions[v][2] = 0.5;
  const TriangleMesh mesh = surface.mesh();
  SelfCollisionOptions options = by(CullingMethod::kAuto), truth = by(CullingMethod::kBvh);
  options.thickness = truth.thickness = std::vector<double>(surface.positions.size(), 0.3);
  const Pairs expected = SelfCollisionFinder(mesh, surface.positions, truth).find_pairs();
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(SelfCollisionFinder(mesh, surface.positions, options).find_pairs(), expected);
}

std::int64_t missed_by(CullingMethod method, const Surface& surface) {
  const Pairs all = pairs_by(CullingMethod::kBvh, surface), found = pairs_by(method, surface);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), found.begin(), found.end()));
  return std::ssize(all) - std::ssize(found);
}

TEST(PublishedConditions, MissPairsOfLoosePieces) {
  const Surface surface = surfaces::crossed_rectangles();
  ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface));
  EXPECT_GT(missed_by(CullingMethod::kDualCone, surface), 0);
  EXPECT_GT(missed_by(CullingMethod::kEnhancedDualConePublished, surface), 0);
}

TEST(PublishedConditions, MissPairsOfOneConnectedPiece) {
  std::int64_t missed_by_dual = 0, missed_by_enhanced = 0;
  for (int turn = 0; turn < 90; turn += 15) {
    const Surface surface = surfaces::overwound_sector(turn);
    EXPECT_FALSE(pairs_by(CullingMethod::kBvh, surface).empty());
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface));
    missed_by_dual += missed_by(CullingMethod::kDualCone, surface);
    missed_by_enhanced += missed_by(CullingMethod::kEnhancedDualConePublished, surface);
  }
  EXPECT_GT(missed_by_dual, 0);
  EXPECT_GT(missed_by_enhanced, 0);
}

TEST(PublishedConditions, MissPairsWithoutAnyBorder) {
  Random random(15);
  std::int64_t missed = 0;
  for (int n = 0; n < 5; ++n) {
    const Surface surface = surfaces::pushed_through(random);
    EXPECT_FALSE(pairs_by(CullingMethod::kBvh, surface).empty());
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface));
    missed += missed_by(CullingMethod::kDualCone, surface);
  }
  EXPECT_GT(missed, 0);
}

/// EDC, Fig. 10: a false negative in so many pairs.
TEST(PublishedConditions, MissPairsOfAShirtStuffedIntoABox) {
  const SurfaceSequence shirt("t-shirt");
  std::int64_t all = 0, missed_by_dual = 0;
  for (const double part : {0.3, 0.6, 0.9}) {
    Surface surface;
    surface.triangles = shirt.triangles();
    surface.positions = shirt.positions(std::floor(part * shirt.frame_count()));
    ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface));
    all += std::ssize(pairs_by(CullingMethod::kBvh, surface));
    missed_by_dual += missed_by(CullingMethod::kDualCone, surface);
  }
  RecordProperty("pairs", std::to_string(all));
  RecordProperty("missed_by_dual_cone", std::to_string(missed_by_dual));
  EXPECT_GT(missed_by_dual, all / 50);
  EXPECT_LT(missed_by_dual, all / 2);
}

/// Nodes that pass all of EDC's conditions as published, and yet hold a pair.
int nodes_culled_in_error(const Surface& surface) {
  PreparedSurface input(surface);
  const SurfaceCones<1> cones(input.bvh, input.pieces, {input.positions});
  const std::vector<Index> place = places(input.bvh);
  const Pairs pairs = pairs_by(CullingMethod::kBvh, surface);
  int count = 0;
  for (Index node = 0; node < static_cast<Index>(input.bvh.nodes().size()); ++node) {
    if (input.bvh.nodes()[node].children[0] >= 0) continue;
    const auto range = input.pieces.ranges()[node];
    const bool holds_pair = std::any_of(pairs.begin(), pairs.end(), [&](const TrianglePair& pair) {
      return range.holds(place[pair.first]) && range.holds(place[pair.second]);
    });
    if (holds_pair && test_enhanced_dual_cone<1>(input.bvh, input.pieces, cones, {input.positions}, node)
                          .all_pass(input.bvh.nodes()[node].child_count))
      ++count;
  }
  return count;
}

TEST(PublishedConditions, AllTogetherDoNotSuffice) {
  int on_sectors = 0;
  for (int turn = 0; turn < 90; turn += 15) on_sectors += nodes_culled_in_error(surfaces::overwound_sector(turn));
  EXPECT_GT(on_sectors, 0);
}

/// Pairs of triangles that lie in two children of a node which EDC's condition 3 takes for apart, of a node that is not
/// culled as a whole: what algorithm 3 skips.
std::int64_t pairs_skipped_between_siblings(const Surface& surface) {
  PreparedSurface input(surface);
  const SurfaceCones<1> cones(input.bvh, input.pieces, {input.positions});
  const std::vector<Index> place = places(input.bvh);
  const Pairs pairs = pairs_by(CullingMethod::kBvh, surface);
  const auto nodes = input.bvh.nodes();
  std::int64_t count = 0;
  for (Index node = 0; node < static_cast<Index>(nodes.size()); ++node) {
    if (nodes[node].children[0] >= 0) continue;
    const auto result = test_enhanced_dual_cone<1>(input.bvh, input.pieces, cones, {input.positions}, node);
    if (result.all_pass(nodes[node].child_count)) continue;
    const auto range = input.pieces.ranges()[node];
    for (const TrianglePair& pair : pairs) {
      if (!range.holds(place[pair.first]) || !range.holds(place[pair.second])) continue;
      const int i = input.pieces.child_at(nodes, node, place[pair.first]);
      const int k = input.pieces.child_at(nodes, node, place[pair.second]);
      count += result.apart[i] >> k & 1;
    }
  }
  return count;
}

// The contour shares of two parts do not meet, and yet one part lies through the inside of the other. Only the
// traversal is to blame: no node of the surface passes all tests, and with them alone nothing is missed.
TEST(PublishedConditions, TraversalSkipsSiblingsThatMeet) {
  const Surface surface = surfaces::crossed_rectangles();
  ASSERT_EQ(nodes_culled_in_error(surface), 0);
  EXPECT_GT(pairs_skipped_between_siblings(surface), 0);
  const TriangleMesh mesh = surface.mesh();
  SelfCollisionOptions options = by(CullingMethod::kEnhancedDualConePublished);
  SelfCollisionCounters skipping, simple;
  const Pairs found = SelfCollisionFinder(mesh, surface.positions, options).find_pairs(&skipping);
  options.simple_traversal = true;
  const Pairs all = SelfCollisionFinder(mesh, surface.positions, options).find_pairs(&simple);
  EXPECT_EQ(all, pairs_by(CullingMethod::kBvh, surface));
  EXPECT_LT(found.size(), all.size());
  EXPECT_LT(skipping.node_pairs, simple.node_pairs);
  EXPECT_LE(skipping.tested_nodes, simple.tested_nodes);
}

}  // namespace

}  // namespace selvage
