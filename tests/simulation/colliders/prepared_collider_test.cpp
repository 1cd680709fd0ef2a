#include "simulation/colliders/prepared_collider.h"

#include "random.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/shapes/shapes.h"
#include "simulation/colliders/colliders.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// One of each kind; the box makes six planes.
std::vector<PreparedCollider> one_of_each_kind() {
  const Vec3 tilted = Vec3(0.3, -0.2, 1).normalized();
  const IndexedMesh ball = make_ball(0.5, 0.2);
  const TetMesh mesh(static_cast<Index>(ball.positions.size()), ball.tetrahedra);
  std::vector<VertexTuple<3>> faces(mesh.boundary_faces().begin(), mesh.boundary_faces().end());
  return prepare_colliders(std::vector<Collider>{{PlaneShape{{0, 0, -0.3}, tilted}},
                                                 {BoxContainer{{-1, -1, -1}, {1, 1, 1}}},
                                                 {Bowl{{0, 0, 0.2}, tilted, 0.9}},
                                                 {SphereShape{{0.2, 0, 0}, 0.4}},
                                                 {CylinderShape{{0, 0.3, 0}, tilted, 0.3, 0.8}},
                                                 {MeshShape{ball.positions, faces}}});
}

TEST(PreparedColliders, AreClearOfNoBoxWithAPointInside) {
  const std::vector<PreparedCollider> colliders = one_of_each_kind();
  ASSERT_EQ(colliders.size(), 11u);
  std::vector<int> clear(colliders.size(), 0), hit(colliders.size(), 0);
  test::Random random(test::seed(7));
  const std::int64_t boxes = test::scaled(20000);
  for (std::int64_t i = 0; i < boxes; ++i) {
    // Also far away, where places are coarse, and as thin as a point.
    const double far = i % 5 == 0 ? 1e6 : 1.3, size = i % 3 == 0 ? 0 : 0.4;
    const auto along = [&](double scale) { return scale * random.within(-1, 1); };
    const Vec3 corner(along(far), along(1.3), along(1.3));
    Eigen::AlignedBox3d box(corner);
    box.extend(Vec3(corner + Vec3(along(size), along(size), along(size))));
    std::vector<Vec3> points;
    for (int k = 0; k < 8; ++k) points.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k)));
    for (int k = 0; k < 8; ++k)
      points.push_back(box.min() + Vec3(random.unit() * box.sizes()[0], random.unit() * box.sizes()[1],
                                        random.unit() * box.sizes()[2]));
    for (std::size_t o = 0; o < colliders.size(); ++o)
      std::visit(
          [&](const auto& shape) {
            const bool is_free = is_clear(shape, box);
            clear[o] += is_free;
            for (const Vec3& p : points) {
              const bool is_inside = find_hit(shape, p).has_value();
              hit[o] += is_inside;
              ASSERT_FALSE(is_free && is_inside) << "collider " << o << ", point " << p.transpose();
            }
          },
          colliders[o].shape);
  }
  // Neither is said of all.
  for (std::size_t o = 0; o < colliders.size(); ++o) {
    EXPECT_GT(clear[o], 0) << o;
    EXPECT_GT(hit[o], 0) << o;
  }
}

/// The way out for a point in a box of 1 m that stands on a floor, nearer to that than to a side.
Vec3 way_out_of_box(double height, const Motion& motion = {}) {
  const MeshShape box = colliders::solid_box({0, 0, height}, {1, 1, height + 1});
  const auto prepared = bury_faces(
      0.1, prepare_colliders(std::vector<Collider>{{.shape = box, .motion = motion}, {.shape = PlaneShape{}}}));
  return std::visit([&](const auto& shape) { return find_hit(shape, Vec3(0.9, 0.5, height + 0.05))->normal; },
                    prepared[0].shape);
}

TEST(PreparedColliders, HaveNoWayOutOntoAnotherThatTheyStandOn) {
  for (const double height : {-0.3, -0.01, 0.0, 0.004}) EXPECT_EQ(way_out_of_box(height), Vec3::UnitX()) << height;
  EXPECT_EQ(way_out_of_box(0.01), -Vec3::UnitZ());  // something thin may be between the two
  Motion rising;
  rising.keyframes = {{.time = 0}, {.time = 1, .translation = Vec3::UnitZ()}};
  EXPECT_EQ(way_out_of_box(0, rising), -Vec3::UnitZ());
}

TEST(PreparedColliders, LeaveACylinderThatStandsOnAFloorByItsOtherEndOrItsSide) {
  const std::vector<Collider> standing{{.shape = CylinderShape{{0, 0, 0.05}, Vec3::UnitZ(), 0.3, 0.1}},
                                       {.shape = PlaneShape{}}};
  const auto prepared = bury_faces(0.1, prepare_colliders(standing));
  const auto leave = [&](const Vec3& p) {
    return std::visit([&](const auto& shape) { return find_hit(shape, p); }, prepared[0].shape);
  };
  EXPECT_EQ(leave({0.1, 0, 0.02})->normal, Vec3::UnitZ());
  EXPECT_NEAR(leave({0.1, 0, 0.02})->depth, 0.08, 1e-12);
  EXPECT_EQ(leave({0.25, 0, 0.02})->normal, Vec3::UnitX());
  EXPECT_FALSE(leave({0.1, 0, 0.11}));
  EXPECT_FALSE(leave({0.1, 0, -0.01}));
}

TEST(PreparedColliders, HaveAWayOutWhereAllFacesAreInAnother) {
  const std::vector<Collider> nested{{.shape = colliders::solid_box({0, 0, 0}, {1, 1, 1})},
                                     {.shape = colliders::solid_box({-1, -1, -1}, {2, 2, 2})}};
  const auto prepared = bury_faces(0.1, prepare_colliders(nested));
  const auto hit = find_hit(std::get<MeshCollider>(prepared[0].shape), Vec3(0.5, 0.5, 0.9));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->depth, 0.1, 1e-12);
}

}  // namespace
}  // namespace selvage
