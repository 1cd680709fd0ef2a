#include "simulation/crossings/collider_crossings.h"

#include "random.h"
#include "simulation/bodies.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// A unit cube from 0 to 1 in cells of 0.25, and its mean edge.
Model cube(const Vec3& offset = Vec3::Zero()) {
  return bodies::make(bodies::moved(make_box(Vec3::Ones(), 0.25), offset), bodies::neo_hookean(1e5));
}

ColliderCrossings measure(const Model& model, const Collider& collider, std::span<const Handle> handles = {},
                          double time = 0) {
  State state = make_state(model, model.rest_positions);
  state.time = time;
  const BoundaryPathFinder<3> finder(model.mesh, state.positions);
  ColliderCrossingFinder crossings(model, {&collider, 1}, handles);
  return crossings.measure(finder, state)[0];
}

Collider box_at(const Vec3& lower, const Vec3& upper) {
  const IndexedMesh mesh = make_box(upper - lower, 10);
  const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  MeshShape shape;
  for (const Vec3& p : mesh.positions) shape.positions.push_back(lower + p);
  shape.triangles.assign(solid.boundary_faces().begin(), solid.boundary_faces().end());
  return {shape};
}

TEST(ColliderCrossings, OfABeamBetweenVerticesAreItsEdges) {
  // Between the planes of vertices at 0.25 and 0.5, its top at a height of 0.1.
  const ColliderCrossings found = measure(cube(), box_at({0.3, -1, -1}, {0.45, 2, 0.1}));
  EXPECT_EQ(found.vertices, 0);
  EXPECT_GT(found.points, 20);
  EXPECT_NEAR(found.deepest_point, 0.1, 1e-12);  // down; its edges run along the cube's bottom
  EXPECT_EQ(found.deepest_vertex, 0);
}

/// All through the cube: no edge of theirs is inside.
TEST(ColliderCrossings, OfAWallAndADiskAreTheirFaces) {
  for (const Collider& collider :
       {box_at({0.3, -9, -9}, {0.45, 9, 9}), Collider{CylinderShape{Vec3(0.375, 0, 0), Vec3::UnitX(), 9, 0.15}}}) {
    const ColliderCrossings found = measure(cube(), collider);
    EXPECT_EQ(found.vertices, 0);
    EXPECT_GT(found.points, 10);
    EXPECT_NEAR(found.deepest_point, 0.4, 0.05 + 1e-12);
    EXPECT_EQ(found.body, 0);
  }
}

TEST(ColliderCrossings, NameTheBodyWhereItIsDeepest) {
  ColliderCrossings sum;
  sum.add({.deepest_vertex = 1e-9, .deepest_in_cells = 1e-8, .body = 0});  // only touches
  EXPECT_EQ(sum.body, kNone);
  sum.add({.points = 1, .body = 3});  // inside, and nobody knows how deep
  EXPECT_EQ(sum.body, 3);
  sum.add({.vertices = 1, .deepest_in_cells = 0.2, .body = 1});
  sum.add({.points = 1, .deepest_in_cells = 0.1, .body = 2});
  EXPECT_EQ(sum.body, 1);
}

TEST(ColliderCrossings, OfACornerAreItsDepth) {
  const ColliderCrossings found = measure(cube(), box_at({-1, -1, -1}, {0.07, 0.06, 0.05}));
  EXPECT_EQ(found.vertices, 1);
  EXPECT_NEAR(found.deepest_vertex, 0.05, 1e-12);  // that at 0, up
  EXPECT_NEAR(found.deepest_point, 0.05, 1e-12);   // its edge that stands on the other two
  EXPECT_GT(found.points, 0);
}

TEST(ColliderCrossings, AreNoneWhereSurfacesTouch) {
  for (const Collider& collider :
       {box_at({-1, -1, -1}, {2, 2, 0}), box_at({0, 0, -1}, {1, 1, 0}),
        Collider{PlaneShape{Vec3::Zero(), Vec3::UnitZ()}}, Collider{BoxContainer{Vec3::Zero(), Vec3::Ones()}}}) {
    const ColliderCrossings found = measure(cube(), collider);
    EXPECT_FALSE(found.any());
    EXPECT_EQ(found.deepest_point, 0);
    EXPECT_EQ(found.deepest_vertex, 0);
  }
}

TEST(ColliderCrossings, OfPlanesAndContainersAreVertices) {
  const ColliderCrossings plane = measure(cube(), {PlaneShape{Vec3(0, 0, 0.3), Vec3::UnitZ()}});
  EXPECT_EQ(plane.vertices, 50);
  EXPECT_NEAR(plane.deepest_vertex, 0.3, 1e-15);
  const ColliderCrossings box = measure(cube(), {BoxContainer{Vec3(-1, -1, -1), Vec3(2, 0.9, 2)}});
  EXPECT_EQ(box.vertices, 25);
  EXPECT_NEAR(box.deepest_vertex, 0.1, 1e-15);
  EXPECT_EQ(box.points, 0);
}

TEST(ColliderCrossings, OfARimOfABowlAreItsPoints) {
  // The rim is a circle of radius 1 in the plane z = 0.3; it enters the cube only near (0.95, 0.3).
  const Model model = cube(Vec3(0.9, -0.5, 0));
  const ColliderCrossings found = measure(model, {Bowl{Vec3(0, 0, 0.3), Vec3::UnitZ(), 1}});
  EXPECT_GT(found.points, 0);
  EXPECT_NEAR(found.deepest_point, 0.1, 0.002);
}

TEST(ColliderCrossings, OfASphereSmallerThanAnElementAreItsSurface) {
  const ColliderCrossings found = measure(cube(), {SphereShape{Vec3(0.6, 0.6, 0.9), 0.05}});
  EXPECT_EQ(found.vertices, 0);
  EXPECT_NEAR(found.deepest_point, 0.15, 1e-12);  // its lowest point
}

TEST(ColliderCrossings, OfANeedleAreItsSide) {
  const ColliderCrossings found = measure(cube(), {CylinderShape{Vec3(0.6, 0.6, 0), Vec3::UnitZ(), 0.02, 1.4}});
  EXPECT_EQ(found.vertices, 0);
  EXPECT_GT(found.deepest_point, 0.36);
  EXPECT_LT(found.deepest_point, 0.42);
}

TEST(ColliderCrossings, FollowTheMotionOfTheCollider) {
  Collider wall = box_at({0.3, -1, -1}, {0.45, 2, 0.9});
  wall.motion.keyframes = {{0, Vec3::Zero(), 0}, {1, Vec3(0, 0, -0.9), 0}};
  EXPECT_NEAR(measure(cube(), wall, {}, 0.85).deepest_point, 0.135, 1e-12);
  EXPECT_FALSE(measure(cube(), wall, {}, 1).any());
}

TEST(ColliderCrossings, LeaveOutWhatHandlesHold) {
  const Model model = cube();
  Handle all;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) all.vertices.push_back(v);
  all.release_time = 1;
  const Collider wall = box_at({0.2, -1, -1}, {0.45, 2, 0.9});
  EXPECT_FALSE(measure(model, wall, {&all, 1}).any());
  EXPECT_TRUE(measure(model, wall, {&all, 1}, 2).any());
}

/// Random boxes: no sampled point can be deeper than the deepest of a dense grid over all six sides, and the two agree
/// within half the spacing.
TEST(ColliderCrossings, OfBoxesAgreeWithADenseGridOfTheirSides) {
  test::Random random(5);
  const Model model = cube();
  double cell = 0;
  for (const auto& e : model.mesh.elements())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) cell += (model.rest_positions[e[a]] - model.rest_positions[e[b]]).norm() / 6;
  cell /= model.mesh.element_count();
  constexpr int kGrid = 200;
  for (int i = 0; i < test::scaled(60); ++i) {
    Vec3 lower, upper;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = random.within(-0.4, 0.9);
      upper[axis] = lower[axis] + random.within(0.05, 0.8);
    }
    double expected = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const double at : {lower[axis], upper[axis]})
        for (int k = 0; k <= kGrid; ++k)
          for (int l = 0; l <= kGrid; ++l) {
            Vec3 p;
            p[axis] = at;
            for (const auto& [other, place] : {std::pair((axis + 1) % 3, k), std::pair((axis + 2) % 3, l)})
              p[other] = lower[other] + (upper[other] - lower[other]) * place / kGrid;
            expected = std::max(expected, std::min(p.minCoeff(), 1 - p.maxCoeff()));
          }
    const double found = measure(model, box_at(lower, upper)).deepest_point;
    EXPECT_LE(found, expected + 4e-3);
    EXPECT_GE(found, expected - 0.5 * cell - 4e-3);
  }
}

}  // namespace
}  // namespace selvage
