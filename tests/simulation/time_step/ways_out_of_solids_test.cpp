// Bodies that start across solids, and the way through these.
#include "simulation/time_step/ways_out_of_solids.h"

#include "simulation/bodies.h"
#include "simulation/colliders/colliders.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// A body at rest where it is, and colliders.
struct Start {
  Model model;
  std::vector<PreparedCollider> colliders;

  Start(const IndexedMesh& mesh, std::vector<Collider> shapes)
      : model(make(std::vector<IndexedMesh>{mesh}, neo_hookean(1e5, 0.4))), colliders(prepare_colliders(shapes)) {}

  /// @param is_blocked  of a way
  std::vector<WayOutOfSolids> ways(const std::function<bool(const Vec3&)>& is_blocked = [](const Vec3&) {
    return false;
  }) const {
    const Pieces pieces(model);
    const std::vector<Vec3> still(model.rest_positions.size(), Vec3::Zero());
    const Step step{
        .number = 1, .start_time = 0, .end_time = 0.01, .positions = model.rest_positions, .velocities = still};
    return ways_out_of_solids(model, pieces, colliders, step, max_corrections_of(model),
                              [&](Index, const Vec3& way, std::span<const Index>) { return is_blocked(way); });
  }
};

IndexedMesh block(double cell = 0.1) {
  return make_box({0.5, 0.5, 0.5}, cell);
}

/// A wall wider than all else, from one x to another.
Collider wall(double from, double to) {
  return {.shape = MeshShape(colliders::solid_box({from, -3, -3}, {to, 3, 3}))};
}

/// The wall has vertices in it, few or more than are asked how far it is, or is between two layers of them.
TEST(WaysOutOfSolids, AreTheShortestThroughTheSolid) {
  for (const auto& [cell, side] : {std::pair{0.1, 0.3}, {0.1, 0.13}, {0.04, 0.3}}) {
    const Start start(block(cell), {Collider{.shape = PlaneShape{{0, 0, -5}}}, wall(0.11, side)});
    const auto ways = start.ways();
    ASSERT_EQ(ways.size(), 1u);
    EXPECT_EQ(ways[0].solids, std::vector<Index>{1});
    EXPECT_LT((ways[0].off.direction - Vec3::UnitX()).norm(), 1e-9);
    EXPECT_NEAR(ways[0].off.way, side, 1e-9);
    const auto back = start.ways([](const Vec3& way) { return way[0] > 0; });
    ASSERT_EQ(back.size(), 1u);
    EXPECT_LT((back[0].off.direction + Vec3::UnitX()).norm(), 1e-9);
    EXPECT_NEAR(back[0].off.way, 0.39, 1e-9);
    EXPECT_TRUE(start.ways([](const Vec3&) { return true; }).empty());
  }
}

TEST(WaysOutOfSolids, LeadThroughAllSolidsAtOnce) {
  const Start start(block(), {wall(0.32, 0.34), wall(0.11, 0.22)});
  const auto ways = start.ways();
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_EQ(ways[0].solids, (std::vector<Index>{0, 1}));
  EXPECT_NEAR(ways[0].off.way, 0.34, 1e-9);
}

/// Of a ball that holds the body's middle, a corner deep in a block, and layers of the body deep in a side of a block.
TEST(WaysOutOfSolids, AreThereWhereTheBodyWouldBeTornOrPressedFlat) {
  for (const Collider& solid : {Collider{.shape = SphereShape{{0.26, 0.24, 0.25}, 0.2}}, wall(0.22, 2),
                                Collider{.shape = MeshShape(colliders::solid_box({-2, -2, -2}, {0.35, 0.35, 2}))}})
    EXPECT_EQ(Start(block(), {solid}).ways().size(), 1u);
}

/// A face a little deep, a needle, a pole onto which a ring is pressed, and a plane.
TEST(WaysOutOfSolids, AreNotWhereContactsBringItOut) {
  EXPECT_TRUE(Start(block(), {wall(0.46, 2)}).ways().empty());
  EXPECT_TRUE(
      Start(block(), {Collider{.shape = CylinderShape{{0.26, 0.23, 0.3}, Vec3::UnitZ(), 0.01, 3}}}).ways().empty());
  EXPECT_TRUE(Start(block(), {Collider{.shape = PlaneShape{{0, 0, 0.3}}}}).ways().empty());
  const IndexedMesh ring = make_torus(0.3, 0.1, 0.05);
  for (const double radius : {0.21, 0.25})
    EXPECT_TRUE(Start(ring, {Collider{.shape = CylinderShape{{0, 0, 0}, Vec3::UnitZ(), radius, 3}}}).ways().empty())
        << radius;
}

}  // namespace
}  // namespace selvage
