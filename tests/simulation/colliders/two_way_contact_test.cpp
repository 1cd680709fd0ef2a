// Bodies on the edges, corners and points of colliders, measured by the elements that hold points of the collider.
#include "random.h"
#include "selvage/boundary_path/boundary_path.h"
#include "simulation/bodies.h"
#include "simulation/colliders/colliders.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>

#include <numbers>

namespace selvage {
namespace {

using namespace bodies;
using namespace colliders;

struct Scenario {
  Model model;
  State state;
  std::vector<Collider> colliders;
  std::vector<Vec3> points;  ///< of the colliders, in their own coordinates
  std::vector<Motion> motions;
  std::int64_t inverted = 0;  ///< elements, over all steps
  double fastest = 0;         ///< vertex after any step [m/s]

  Scenario(std::span<const IndexedMesh> meshes, const Vec3& velocity) : model(make(meshes, neo_hookean(2e5, 0.35))) {
    state = make_state(model, model.rest_positions);
    for (Vec3& v : state.velocities) v = velocity;
    colliders.push_back({.shape = PlaneShape{}});
  }

  void add(const Vec3& lower, const Vec3& upper, const Motion& motion = {}) {
    colliders.push_back({.shape = solid_box(lower, upper), .motion = motion});
    for (const Vec3& p : edge_points(lower, upper, 60)) {
      points.push_back(p);
      motions.push_back(motion);
    }
  }

  /// Points just behind one side of a box, across the first axis: where a body lies against it none is on its surface.
  void add_side(const Vec3& lower, const Vec3& upper) {
    constexpr int kParts = 20;
    for (int i = 0; i <= kParts; ++i)
      for (int k = 0; k <= kParts; ++k) {
        points.push_back(lower + (upper - lower).cwiseProduct(Vec3(0.1, i, k) / kParts));
        motions.emplace_back();
      }
  }

  /// Runs steps, and measures after each tenth.
  /// @return the deepest that a point of a collider was in an element [m]
  double run(int steps) {
    XpbdSolver solver(model, state, {}, colliders, XpbdOptions{});
    PointLocator<3> locator(model.mesh, state.positions);
    BoundaryPathFinder<3> paths(locator);
    double deepest = 0;
    for (int i = 1; i <= steps; ++i) {
      solver.step(state);
      inverted += inverted_elements(model, state);
      for (const Vec3& v : state.velocities) fastest = std::max(fastest, v.norm());
      if (i % 10 != 0) continue;
      locator.update(state.positions);
      paths.update();
      std::vector<Vec3> now;
      for (std::size_t k = 0; k < points.size(); ++k) now.push_back(motions[k].at(state.time)(points[k]));
      for (const auto& path : paths.find_paths(locator.locate(now).queries)) deepest = std::max(deepest, path.distance);
    }
    return deepest;
  }
};

constexpr double kCell = 0.125;
/// Part of a cell by which a point of a collider may be inside.
constexpr double kDepth = 0.02;

IndexedMesh block(const Vec3& offset) {
  return moved(make_box(Vec3(0.5, 0.5, 0.5), kCell), offset - Vec3(0.25, 0.25, 0));
}

double lowest(const State& state) {
  double z = HUGE_VAL;
  for (const Vec3& p : state.positions) z = std::min(z, p[2]);
  return z;
}

TEST(TwoWayContact, AWallThinnerThanACellCarriesABlock) {
  const std::array meshes{block({0, 0, 0.62})};
  Scenario scenario(meshes, Vec3::Zero());
  scenario.add({-1, -0.03, 0}, {1, 0.03, 0.6});
  EXPECT_LT(scenario.run(150), kDepth * kCell);
  EXPECT_GT(lowest(scenario.state), 0.3);
}

TEST(TwoWayContact, BladesNarrowerThanACellCarryABlock) {
  const std::array meshes{block({0, 0, 0.7})};
  Scenario scenario(meshes, Vec3::Zero());
  for (int k = -2; k <= 2; ++k) scenario.add({0.1 * k - 0.005, -1, 0}, {0.1 * k + 0.005, 1, 0.6});
  EXPECT_LT(scenario.run(200), kDepth * kCell);
  EXPECT_GT(lowest(scenario.state), 0.55);
}

TEST(TwoWayContact, ABlockFallsFastOnACornerAndOnAnEdge) {
  for (const double degrees : {0.0, 45.0}) {
    const std::array meshes{block({0, 0, 1.2})};
    Scenario scenario(meshes, Vec3(0, 0, -10));
    Motion tilted;
    tilted.axis = Vec3(1, degrees > 0 ? 1 : 0, 0);
    tilted.keyframes = {{.time = 0, .angle = std::numbers::pi / 4}};
    tilted.centre = Vec3(0, 0, 0.4);
    scenario.add({-0.25, -0.25, 0.15}, {0.25, 0.25, 0.65}, tilted);
    EXPECT_LT(scenario.run(150), kDepth * kCell);
  }
}

TEST(TwoWayContact, NothingPassesAPlateAtFortyMetresASecond) {
  const std::array meshes{block({0, 0.8, 0.3})};
  Scenario scenario(meshes, Vec3(0, -40, 0));
  scenario.add({-1, -0.005, 0}, {1, 0.005, 1.5});
  EXPECT_LT(scenario.run(40), kDepth * kCell);
  for (const Vec3& p : scenario.state.positions) EXPECT_GT(p[1], 0);
}

TEST(TwoWayContact, ABladeThatTurnsSweepsABlockAway) {
  const std::array meshes{block({0.5, 0.3, 0.01})};
  Scenario scenario(meshes, Vec3::Zero());
  Motion motion;
  motion.keyframes = {{.time = 0}, {.time = 1, .angle = 2 * std::numbers::pi}};
  scenario.add({-1, -0.01, 0.2}, {1, 0.01, 0.3}, motion);
  EXPECT_LT(scenario.run(200), kDepth * kCell);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : scenario.state.positions) mean += p / static_cast<double>(scenario.state.positions.size());
  EXPECT_GT((mean - Vec3(0.5, 0.3, 0.25)).norm(), 0.3);
}

TEST(TwoWayContact, WhatStartsInsideComesOutAndDoesNotFlyOff) {
  const std::array meshes{block({0, 0, 0.5})};
  Scenario scenario(meshes, Vec3::Zero());
  scenario.add({-1, -0.01, 0}, {1, 0.01, 0.55});
  scenario.run(300);
  const double at_end = scenario.run(10);
  EXPECT_LT(at_end, kDepth * kCell);
  double fastest = 0;
  for (const Vec3& v : scenario.state.velocities) fastest = std::max(fastest, v.norm());
  EXPECT_LT(fastest, 5);
}

/// A needle through the middle of a block that stands on the floor, and a box in it.
TEST(TwoWayContact, ABlockComesFreeOfWhatPiercesItGently) {
  // A needle, a box, and two plates: from below, and from one side to beyond the middle.
  const std::array<std::array<Vec3, 2>, 4> pierced{{{Vec3(-0.005, -0.005, 0), Vec3(0.005, 0.005, 0.8)},
                                                    {Vec3(-0.02, -0.08, 0.2), Vec3(0.08, 0.02, 0.3)},
                                                    {Vec3(0.05, -0.15, 0), Vec3(0.07, 0.2, 0.3)},
                                                    {Vec3(-0.013, -0.1, 0), Vec3(0.013, 0.5, 0.8)}}};
  for (const auto& [lower, upper] : pierced) {
    const std::array meshes{block({0, 0, 0.001})};
    Scenario scenario(meshes, Vec3::Zero());
    scenario.add(lower, upper);
    EXPECT_GT(scenario.run(10), 0.5 * kCell);
    scenario.run(600);
    EXPECT_LT(scenario.run(10), kDepth * kCell);
    EXPECT_LT(scenario.fastest, 20);
    EXPECT_EQ(scenario.inverted, 0);
  }
}

/// No edge of these walls is inside, and no vertex of the block is in them.
TEST(TwoWayContact, ABlockComesFreeOfAWallAllThroughIt) {
  const std::array<std::array<Vec3, 2>, 2> walls{
      {{Vec3(0.03, -0.3, -0.1), Vec3(0.06, 0.4, 0.6)}, {Vec3(-0.1, -0.5, -0.1), Vec3(-0.05, 0.35, 0.55)}}};
  for (const auto& [lower, upper] : walls) {
    const std::array meshes{block({0, 0, 0.02})};
    Scenario scenario(meshes, Vec3::Zero());
    scenario.add(lower, upper);
    EXPECT_EQ(scenario.run(0), 0);
    scenario.add_side(lower, upper);
    EXPECT_GT(scenario.run(10), 0.6 * kCell);
    scenario.run(900);
    EXPECT_LT(scenario.run(10), kDepth * kCell);
    EXPECT_LT(scenario.fastest, 20);
    EXPECT_EQ(scenario.inverted, 0);
  }
}

/// What handles hold stays where they hold it, and what they do not comes off the needle.
TEST(TwoWayContact, APinnedBlockIsNotDrawnOffWhatPiercesIt) {
  const std::array meshes{block({0, 0, 0.001})};
  Scenario scenario(meshes, Vec3::Zero());
  scenario.add({-0.005, -0.005, 0.45}, {0.005, 0.005, 0.9});
  for (Index v = 0; v < scenario.model.mesh.vertex_count(); ++v)
    if (scenario.state.positions[v][2] < 0.1) scenario.model.inverse_masses[v] = 0;
  const std::vector<Vec3> start = scenario.state.positions;
  scenario.run(300);
  for (Index v = 0; v < scenario.model.mesh.vertex_count(); ++v) {
    const double moved = (scenario.state.positions[v] - start[v]).norm();
    EXPECT_LE(moved, scenario.model.inverse_masses[v] > 0 ? 0.2 : 0.0);
  }
  EXPECT_LT(scenario.run(10), kDepth * kCell);
  EXPECT_EQ(scenario.inverted, 0);
}

/// Boxes, needles and plates at random, one of which turns, under a block that falls.
Scenario random_scenario(test::Random& random) {
  const std::array meshes{block({random.within(-0.2, 0.2), random.within(-0.2, 0.2), 1})};
  Scenario scenario(meshes, Vec3(random.within(-2, 2), random.within(-2, 2), random.within(-10, 0)));
  for (int k = 0; k < 3; ++k) {
    Motion motion;
    motion.axis = random.vector(1);
    motion.centre = Vec3(0, 0, 0.4);
    const double start = random.within(0, 6), turn = k == 0 ? random.within(-6, 6) : 0.0;
    motion.keyframes = {{.time = 0, .angle = start}, {.time = 1, .angle = start + turn}};
    const Vec3 half(random.within(0.002, 0.3), random.within(0.002, 0.3), random.within(0.05, 0.3));
    scenario.add(motion.centre - half, motion.centre + half, motion);
  }
  return scenario;
}

TEST(TwoWayContact, HoldsAtRandom) {
  test::Random random(test::seed(1));
  for (std::int64_t n = 0; n < test::scaled(12, 2); ++n)
    EXPECT_LT(random_scenario(random).run(120), kDepth * kCell) << "case " << n;
}

/// A box that turns presses the block against one that stands.
TEST(TwoWayContact, HoldsBetweenCollidersThatClose) {
  test::Random random(1);
  for (int n = 0; n <= 197; ++n) {
    Scenario scenario = random_scenario(random);
    if (n != 173 && n != 197) continue;
    EXPECT_LT(scenario.run(120), kDepth * kCell) << "case " << n;
  }
}

/// Colliders leave an element between them no room. One gets in by a part of a cell; if the element were inverted in
/// place of that, nothing would hold its vertices back any more, and half a cell would follow.
TEST(TwoWayContact, InvertsNoElementThatHasNoRoom) {
  for (const auto& [seed, number] : {std::pair{2, 64}, std::pair{4, 102}}) {
    test::Random random(seed);
    for (int n = 0; n < number; ++n) random_scenario(random);
    Scenario scenario = random_scenario(random);
    EXPECT_LT(scenario.run(40), 0.25 * kCell) << "seed " << seed;
    EXPECT_EQ(scenario.inverted, 0) << "seed " << seed;
  }
}

TEST(TwoWayContact, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> first;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const std::array meshes{block({0.1, 0, 0.65})};
    Scenario scenario(meshes, Vec3(0, 0, -2));
    scenario.add({-1, -0.03, 0}, {1, 0.03, 0.6});
    scenario.run(60);
    if (first.empty()) first = scenario.state.positions;
    EXPECT_EQ(first, scenario.state.positions);
  }
}

}  // namespace
}  // namespace selvage
