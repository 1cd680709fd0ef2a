#include "simulation/colliders/passage.h"

#include "random.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

MeshCollider mesh_collider(const IndexedMesh& file) {
  const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  return {"mesh", {file.positions, {mesh.boundary_faces().begin(), mesh.boundary_faces().end()}}};
}

/// Where a way is inside, by trying many places of it: the first and the last.
template <typename Shape>
std::optional<std::pair<double, double>> try_places(const Shape& shape, const Vec3& from, const Vec3& to, int places) {
  std::optional<std::pair<double, double>> ends;
  for (int i = 0; i <= places; ++i) {
    const double at = static_cast<double>(i) / places;
    if (!find_hit(shape, from + at * (to - from))) continue;
    if (!ends) ends = {at, at};
    ends->second = at;
  }
  return ends;
}

template <typename Shape>
void compare_with_places(const Shape& shape, const char* name) {
  constexpr int kPlaces = 400;
  test::Random random(test::seed(3));
  const auto place = [&] { return Vec3(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1)); };
  int through = 0, past = 0, ending = 0;
  const std::int64_t ways = test::scaled(400);
  for (std::int64_t n = 0; n < ways; ++n) {
    const Vec3 from = 1.5 * place(), to = 1.5 * place(), way = to - from;
    if (find_hit(shape, from)) continue;
    const auto ends = try_places(shape, from, to, kPlaces);
    const auto passage = find_passage(shape, from, to);
    if (!ends) {
      // Nothing, or less than between two places.
      past += !passage;
      continue;
    }
    ASSERT_TRUE(passage) << name;
    const double at = (passage->entry - from).dot(way) / way.squaredNorm();
    EXPECT_LT(at, ends->first + 0.01 / kPlaces) << name;
    // Or it grazes a corner between two places before.
    EXPECT_TRUE(at > ends->first - 1.01 / kPlaces || find_hit(shape, passage->entry + 1e-9 * way)) << name;
    EXPECT_LT(passage->entry_normal.dot(way), 0) << name;
    EXPECT_NEAR(passage->entry_normal.norm(), 1, 1e-9) << name;
    if (ends->second < 1) {
      EXPECT_GT(passage->exit_normal.dot(way), 0) << name;
      ++through;
    } else {
      ++ending;
    }
  }
  EXPECT_GT(std::min({through, past, ending}), test::quota(ways, 0.03)) << name;
}

TEST(Passage, IsThatOfDensePointsOnTheWay) {
  compare_with_places(SphereShape{{0.2, 0.1, 0}, 0.7}, "sphere");
  compare_with_places(PreparedCylinder{{{0, 0.1, 0.1}, Vec3(1, 2, 3).normalized(), 0.6, 1}}, "cylinder");
  compare_with_places(mesh_collider(make_ball(0.8, 0.3)), "ball");
  compare_with_places(mesh_collider(make_torus(0.8, 0.35, 0.2)), "torus");
}

TEST(Passage, LeadsBackOnlyWhereTheWayWentThrough) {
  const PreparedCylinder plate{{Vec3::Zero(), Vec3::UnitZ(), 2, 0.1}};
  // Through, to past the middle, and not as far.
  for (const double depth : {0.5, 0.08, 0.02}) {
    const auto hit = find_hit_on_way(plate, Vec3(0, 0, 0.05), Vec3(0.1, 0, 0.05 - depth));
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->normal, Vec3::UnitZ().eval());
    EXPECT_NEAR(hit->depth, depth, 1e-15);
  }
  EXPECT_FALSE(find_hit_on_way(plate, Vec3(0, 0, 0.05), Vec3(0.1, 0, 0.07)));
  EXPECT_FALSE(find_hit_on_way(plate, Vec3(0, 0, -0.06), Vec3(1, 0, -0.9)));
  // Around the rim, where no way back is better than the other.
  EXPECT_FALSE(find_hit_on_way(plate, Vec3(1.99, 0, 0.06), Vec3(2.1, 0, 0.02)));
  // Over a round side.
  const SphereShape ball{Vec3::Zero(), 1};
  EXPECT_FALSE(find_hit_on_way(ball, Vec3(-0.2, 0, 1), Vec3(0.2, 0, 1)));
  ASSERT_TRUE(find_hit_on_way(ball, Vec3(0.1, 0, 3), Vec3(0, 0, -3)));
  EXPECT_GT(find_hit_on_way(ball, Vec3(0.1, 0, 3), Vec3(0, 0, -3))->normal[2], 0.9);
  // What starts inside goes the shortest way.
  EXPECT_EQ(find_hit_on_way(ball, Vec3(0, 0, 0.2), Vec3(0, 0, -0.5))->normal, Vec3(0, 0, -1));
}

}  // namespace
}  // namespace selvage
