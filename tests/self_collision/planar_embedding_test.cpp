#include "self_collision/culling/planar_embedding.h"

#include "self_collision/culling_surfaces.h"
#include "self_collision/prepared_surface.h"
#include "self_collision/surface/swept_surface.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;

TEST(PlanarEmbeddingTest, IsNotFooledByNestedContours) {
  const Surface surface = surfaces::crosswise_squares();
  EXPECT_FALSE(pairs_by(CullingMethod::kBvh, surface).empty());
  PreparedSurface input(surface);
  const ProjectionPlane plane = plane_across(Vec3(0, 0, 1));
  EXPECT_EQ(input.contours(0).loops.size(), 2u);
  EXPECT_TRUE(input.embedding.do_triangles_face(0, plane));
  EXPECT_FALSE(input.embedding.is_contour_embedded(0, plane, input.workspace));
  ASSERT_NO_FATAL_FAILURE(expect_methods_agree(surface));
}

TEST(PlanarEmbeddingTest, CullsSheetsSideBySideAndWithHoles) {
  Random random(16);
  Surface left = surfaces::sheet(6, 6, random), right = left;
  for (Vec3& x : right.positions) x[0] += 7;
  Surface both = surfaces::together(left, right);
  PreparedSurface two(both);
  EXPECT_TRUE(two.embedding.is_embedded(0, two.workspace));
  for (Vec3& x : right.positions) x += Vec3(-6.5, 0.2, 1);
  PreparedSurface above(surfaces::together(left, right));
  EXPECT_FALSE(above.embedding.is_embedded(0, above.workspace));
  std::erase_if(left.triangles, [&](const VertexTuple<3>& t) {
    const Vec3 middle = (left.positions[t[0]] + left.positions[t[1]] + left.positions[t[2]]) / 3;
    return middle[0] > 2 && middle[0] < 4 && middle[1] > 2 && middle[1] < 4;
  });
  PreparedSurface holed(left);
  EXPECT_EQ(holed.contours(0).loops.size(), 2u);
  EXPECT_TRUE(holed.embedding.is_embedded(0, holed.workspace));
}

TEST(PlanarEmbeddingTest, DoesNotDependOnOrientation) {
  Random random(17);
  Surface surface = surfaces::sheet(8, 8, random);
  for (VertexTuple<3>& t : surface.triangles)
    if (random.below(2) == 0) std::swap(t[0], t[1]);
  PreparedSurface input(surface);
  EXPECT_TRUE(input.embedding.is_embedded(0, input.workspace));
}

// A piece that passes the test holds no pair at all, adjacent ones included: each pair that the hierarchy alone
// finds is looked up in every node.
TEST(PlanarEmbeddingTest, NoEmbeddedPieceHoldsAPair) {
  Random random(18);
  std::int64_t passed = 0;
  for (std::int64_t n = 0; n < scaled(400); ++n) {
    const auto& families = surfaces::families();
    Surface surface = n % 2 == 0 ? surfaces::waved_sheet(random)
                                 : families[random.below(static_cast<Index>(families.size()))].make(random);
    if (n % 5 == 0) surface = surfaces::snapped(surface, 2);
    PreparedSurface input(surface);
    const std::vector<Index> place = places(input.bvh);
    const Pairs pairs = pairs_by(CullingMethod::kBvh, surface, true);
    for (Index node = 0; node < static_cast<Index>(input.bvh.nodes().size()); ++node) {
      if (!input.embedding.is_embedded(node, input.workspace)) continue;
      ++passed;
      const auto range = input.pieces.ranges()[node];
      for (const TrianglePair& pair : pairs)
        ASSERT_FALSE(range.holds(place[pair.first]) && range.holds(place[pair.second])) << n;
    }
  }
  EXPECT_GT(passed, scaled(400));
}

/// Every vertex part of the way from one pose to another.
std::vector<Vec3> between(std::span<const Vec3> from, std::span<const Vec3> to, double t) {
  std::vector<Vec3> positions;
  for (std::size_t v = 0; v < from.size(); ++v) positions.push_back((1 - t) * from[v] + t * to[v]);
  return positions;
}

// Over a step: a piece that is embedded all the time holds no pair at any time.
TEST(PlanarEmbeddingTest, NoMovingEmbeddedPieceHoldsAPairAtAnyTime) {
  Random random(19);
  std::int64_t passed = 0, passed_in_box_units = 0;
  for (std::int64_t n = 0; n < scaled(150); ++n) {
    const Surface surface = surfaces::waved_sheet(random);
    const Surface end = surfaces::jittered(surface, random.unit() * random.unit(), random);
    PreparedSurface input(surface);
    PlanarEmbeddingTest<2> moving, moving_in_box_units;
    PlanarEmbeddingTest<2>::Workspace workspace;
    moving.place(input.pieces, {input.positions, end.positions});
    PositionExtent<3> both = extent_of<3>(std::span<const Vec3>(input.positions));
    both.add(extent_of<3>(std::span<const Vec3>(end.positions)));
    SweptSurface pose;
    pose.place(input.mesh, input.positions, end.positions, {}, box_units_around(both));
    moving_in_box_units.place(input.pieces, {input.positions, end.positions}, pose.rounded());
    const std::vector<Index> place = places(input.bvh);
    std::vector<Pairs> pairs;
    for (const double t : {0.0, 0.2, 0.5, 0.7, 1.0})
      pairs.push_back(
          pairs_by(CullingMethod::kBvh, {between(surface.positions, end.positions, t), surface.triangles}, true));
    for (Index node = 0; node < static_cast<Index>(input.bvh.nodes().size()); ++node) {
      const bool is_embedded = moving.is_embedded(node, workspace);
      const bool is_embedded_in_box_units = moving_in_box_units.is_embedded(node, workspace);
      passed += is_embedded;
      passed_in_box_units += is_embedded_in_box_units;
      if (!is_embedded && !is_embedded_in_box_units) continue;
      const auto range = input.pieces.ranges()[node];
      for (const Pairs& at_one_time : pairs)
        for (const TrianglePair& pair : at_one_time)
          ASSERT_FALSE(range.holds(place[pair.first]) && range.holds(place[pair.second])) << n;
    }
  }
  EXPECT_GT(passed, scaled(150));
  EXPECT_GT(passed_in_box_units, 0.98 * static_cast<double>(passed));
}

// A square turned over within the step: embedded at both ends, and flat against an edge between.
TEST(PlanarEmbeddingTest, SeesWhatHappensBetweenTheEnds) {
  Random random(20);
  const Surface surface = surfaces::sheet(6, 6, random);
  Surface mirrored = surface;
  for (Vec3& x : mirrored.positions) x[0] = 6 - x[0];
  PreparedSurface input(surface), end(mirrored);
  EXPECT_TRUE(input.embedding.is_embedded(0, input.workspace));
  EXPECT_TRUE(end.embedding.is_embedded(0, end.workspace));
  PlanarEmbeddingTest<2> moving;
  PlanarEmbeddingTest<2>::Workspace workspace;
  moving.place(input.pieces, {input.positions, mirrored.positions});
  EXPECT_FALSE(moving.is_embedded(0, workspace));
  // Without a change of shape there is nothing to see.
  for (std::size_t v = 0; v < mirrored.positions.size(); ++v)
    mirrored.positions[v] = input.positions[v] + Vec3(1, 2, 3);
  moving.place(input.pieces, {input.positions, mirrored.positions});
  EXPECT_TRUE(moving.is_embedded(0, workspace));
}

}  // namespace

}  // namespace selvage
