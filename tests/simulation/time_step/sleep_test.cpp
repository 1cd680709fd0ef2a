// Bodies at rest lie still, and wake for whatever a body would feel.
#include "simulation/time_step/sleep.h"
#include "simulation/bodies.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace selvage {
namespace {

using namespace bodies;

constexpr double kStep = 1.0 / 300;

XpbdOptions sleeping() {
  XpbdOptions options;
  options.time_step = kStep;
  options.sleep_speed = 0.015;
  return options;
}

Collider floor_at(double height) {
  return {.shape = PlaneShape{Vec3(0, 0, height), Vec3::UnitZ()}};
}

IndexedMesh block(double side, const Vec3& corner) {
  return moved(make_box({side, side, side}, side / 2), corner);
}

Material rubber() {
  return damped(neo_hookean(1e5, 0.4), 0.005);
}

struct Stage {
  Model model;
  State state;
  XpbdSolver solver;

  Stage(Model m, const XpbdOptions& options, std::vector<Collider> colliders, std::vector<Handle> handles = {})
      : model(std::move(m)),
        state(make_state(model, model.rest_positions)),
        solver(model, state, std::move(handles), std::move(colliders), options) {}

  std::int64_t sleepers() const { return solver.statistics().sleeping_bodies; }

  /// Steps until so many sleep; false where that takes more than ten seconds.
  bool run_until(std::int64_t count) {
    for (int step = 0; step < 3000; ++step) {
      solver.step(state);
      if (sleepers() == count) return true;
    }
    return false;
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) solver.step(state);
  }
};

TEST(Sleep, HoldsAHeapStillThatIsAtRest) {
  const Model model = make(std::vector{block(0.2, {0, 0, 0.01}), block(0.2, {0.02, 0.03, 0.23})}, rubber());
  Stage heap(model, sleeping(), {floor_at(0)});
  ASSERT_TRUE(heap.run_until(2));
  const State before = heap.state;
  heap.run(300);
  EXPECT_EQ(heap.sleepers(), 2);
  EXPECT_EQ(heap.state.positions, before.positions);
  EXPECT_EQ(kinetic_energy(model, heap.state), 0);
  EXPECT_EQ(heap.state.steps, before.steps + 300);
  EXPECT_NEAR(heap.state.time, heap.state.steps * kStep, 1e-9);

  XpbdOptions awake = sleeping();
  awake.sleep_speed = 0;
  Stage other(model, awake, {floor_at(0)});
  other.run(static_cast<int>(before.steps));
  EXPECT_EQ(other.sleepers(), 0);
  EXPECT_TRUE(other.state.rest_times.empty());
}

TEST(Sleep, ComesToNothingThatFliesOrDrifts) {
  // At the top of its flight a body is slow for a moment; without gravity it is slow for ever.
  Stage thrown(make(block(0.2, {0, 0, 0}), rubber()), sleeping(), {});
  for (Vec3& v : thrown.state.velocities) v = Vec3(0, 0, 2);
  for (int step = 0; step < 300; ++step) {
    thrown.solver.step(thrown.state);
    ASSERT_EQ(thrown.sleepers(), 0);
  }
  EXPECT_NEAR(thrown.state.velocities[0][2], 2 - 9.81, 1e-9);

  XpbdOptions weightless = sleeping();
  weightless.gravity.setZero();
  Stage drifting(make(block(0.2, {0, 0, 0}), rubber()), weightless, {});
  for (Vec3& v : drifting.state.velocities) v = Vec3(0.001, 0, 0);
  drifting.run(600);
  EXPECT_EQ(drifting.sleepers(), 0);
  EXPECT_NEAR(drifting.state.positions[0][0], 0.002, 1e-12);
}

TEST(Sleep, EndsWhereSomethingFallsOnTheHeap) {
  // The third falls from so high that the two others sleep by then.
  Stage heap(make(std::vector{block(0.2, {0, 0, 0.001}), block(0.2, {0.03, 0, 0.205}), block(0.2, {0.05, 0.02, 45})},
                  rubber()),
             sleeping(), {floor_at(0)});
  ASSERT_TRUE(heap.run_until(2));
  const Vec3 before = heap.state.positions[30];
  ASSERT_TRUE(heap.run_until(0));
  EXPECT_GT(heap.state.positions[2 * 27][2], 0.3);  // it arrives in this step
  heap.run(30);
  EXPECT_NE(heap.state.positions[30], before);
  EXPECT_TRUE(heap.run_until(3));
}

TEST(Sleep, EndsWhereACarrierMoves) {
  // A plate is pulled away from under a block after three seconds, slower than what counts as fast.
  MeshShape plate;
  const IndexedMesh solid = moved(make_box({0.5, 0.5, 0.1}, 0.5), {-0.25, -0.25, -0.1});
  plate.positions = solid.positions;
  const TetMesh topology(static_cast<Index>(solid.positions.size()), solid.tetrahedra);
  plate.triangles.assign(topology.boundary_faces().begin(), topology.boundary_faces().end());
  Collider shelf{.shape = plate, .friction = {0, 0}};
  shelf.motion.keyframes = {{.time = 3}, {.time = 23, .translation = Vec3(1, 0, 0)}};
  Stage run(make(block(0.2, {-0.1, -0.1, 0.001}), rubber()), sleeping(), {shelf});
  ASSERT_TRUE(run.run_until(1));
  ASSERT_LT(run.state.time, 3);
  ASSERT_TRUE(run.run_until(0));
  EXPECT_NEAR(run.state.time, 3, 0.01);
  for (int step = 0; step < 15 * 300 && run.state.positions[0][2] > -1; ++step) {
    run.solver.step(run.state);
    ASSERT_EQ(run.sleepers(), 0);
  }
  EXPECT_LE(run.state.positions[0][2], -1);
}

TEST(Sleep, EndsWhereAHandleMovesOrLetsGo) {
  for (const bool is_released : {false, true}) {
    const Model model = make(block(0.2, {0, 0, 1}), rubber());
    Handle top = hold(model, [](const Vec3& p) { return p[2] > 1.19; });
    if (is_released) top.release_time = 4;
    if (!is_released) top.motion.keyframes = {{.time = 4}, {.time = 6, .translation = Vec3(0, 0, 0.01)}};
    Stage run(model, sleeping(), {}, {top});
    ASSERT_TRUE(run.run_until(1));
    ASSERT_LT(run.state.time, 4);
    ASSERT_TRUE(run.run_until(0));
    EXPECT_NEAR(run.state.time, 4, 0.01);
    run.run(150);
    EXPECT_EQ(run.sleepers(), 0);
  }
}

TEST(Sleep, EndsWhereTheUserActs) {
  const Model model = make(block(0.2, {0, 0, 0.001}), rubber());
  const auto asleep = [&] {
    auto run = std::make_unique<Stage>(model, sleeping(), std::vector{floor_at(0)});
    EXPECT_TRUE(run->run_until(1));
    return run;
  };
  {
    const auto run = asleep();
    const std::vector<Vec3> forces(model.mesh.vertex_count(), Vec3(100, 0, 0));
    for (int i = 0; i < 10; ++i) run->solver.step(run->state, forces);
    EXPECT_EQ(run->sleepers(), 0);
    EXPECT_GT(run->state.velocities[0][0], 0);
  }
  {
    const auto run = asleep();
    for (Vec3& v : run->state.velocities) v = Vec3(0, 0, 1);
    run->solver.step(run->state);
    EXPECT_EQ(run->sleepers(), 0);
    EXPECT_GT(run->state.velocities[0][2], 0.5);
  }
  {
    const auto run = asleep();
    for (Vec3& p : run->state.positions) p[2] += 0.5;
    run->state.rest_times.clear();
    run->run(10);
    EXPECT_LT(run->state.velocities[0][2], -0.3);
  }
  {
    const auto run = asleep();
    int calls = 0;
    run->solver.set_constraint([&](const StepVertices&, int) { ++calls; });
    run->run(200);
    EXPECT_EQ(run->sleepers(), 0);
    EXPECT_GT(calls, 200);
  }
}

TEST(Sleep, SettlesWhatMovesInAGroupAndLetsTheGroupGlideOn) {
  // Two blocks beside one another on smooth ground, the one faster than the other; a third glides alone.
  Collider ice = floor_at(0);
  ice.friction = {0, 0};
  Stage run(make(std::vector{block(0.2, {0, 0, 0}), block(0.2, {0, 0.201, 0}), block(0.2, {9, 0, 0})}, rubber()),
            sleeping(), {ice});
  constexpr Index kVertices = 27;
  for (Index v = 0; v < 3 * kVertices; ++v) run.state.velocities[v] = Vec3(v < kVertices ? 0.12 : 0.08, 0, 0);
  run.run(150);
  const auto speed = [&](Index block) { return run.state.velocities[block * kVertices][0]; };
  EXPECT_LT(std::abs(speed(0) - speed(1)), 0.01);
  EXPECT_NEAR((speed(0) + speed(1)) / 2, 0.1, 1e-3);
  EXPECT_NEAR(speed(2), 0.08, 1e-3);
}

/// A ball of facets on a slope, in coordinates in which the floor is level.
Stage ball_on_slope(double degrees, double speed) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.27, Vec3(0.9, -0.53, 0.22).normalized()).toRotationMatrix();
  IndexedMesh ball = make_ball(0.25, 0.1);
  for (Vec3& p : ball.positions) p = turn * p + Vec3(0, 0, 0.251);
  XpbdOptions options = sleeping();
  options.iterations = 3;
  options.deformation_damping = 1;
  const double angle = degrees * std::numbers::pi / 180;
  options.gravity = 9.81 * Vec3(std::sin(angle), 0, -std::cos(angle));
  Material hard = damped(neo_hookean(1e6, 0.4), 0.002);
  hard.density = 500;
  Stage stage(make(ball, hard), options, {floor_at(0)});
  for (Vec3& v : stage.state.velocities) v = Vec3(speed, 0.4 * speed, 0);
  return stage;
}

TEST(Sleep, BringsABallToRestThatRolls) {
  // Nothing else resists it: without, this one rolls from facet to facet for a minute.
  EXPECT_TRUE(ball_on_slope(0, 0.2).run_until(1));
}

TEST(Sleep, LetsABallRollDownASlope) {
  Stage run = ball_on_slope(3, 0);
  const double start = centre(run.model, run.state)[0];
  run.run(900);
  const double way = centre(run.model, run.state)[0] - start;
  const double smooth = 5.0 / 7 * 9.81 * std::sin(3 * std::numbers::pi / 180) * 9 / 2;
  EXPECT_GT(way, 0.6 * smooth);
  EXPECT_LT(way, smooth);
}

TEST(Sleep, LeavesTheSpinOfWhatFlies) {
  // A body so large that it is slow for a quarter of a second at the top of its flight.
  Stage thrown(make(block(10, {-5, -5, -5}), rubber()), sleeping(), {floor_at(-20)});
  const Vec3 turn(0, 0, 0.05);
  for (std::size_t v = 0; v < thrown.state.velocities.size(); ++v)
    thrown.state.velocities[v] = Vec3(0, 0, 1) + turn.cross(thrown.state.positions[v]);
  const Vec3 before = angular_momentum(thrown.model, thrown.state);
  thrown.run(90);
  EXPECT_LT((angular_momentum(thrown.model, thrown.state) - before).norm(), 1e-9 * before.norm());
}

/// Steps of two blocks until both sleep, vertices shaken to and fro at a speed while all move at another; 3000 where
/// they do not.
/// @param gap    between the two [m]
/// @param every  one vertex in so many is shaken
int steps_until_asleep(double gap, double shaking, const Vec3& common, int every = 1) {
  const Model model = make(std::vector{block(0.2, {0, 0, 0}), block(0.2, {0, 0, 0.2 + gap})}, rubber());
  State state = make_state(model, model.rest_positions);
  Sleep sleep(model, 0.015, Vec3(0, 0, -9.81));
  const auto time = [](int step) { return step * kStep; };
  for (int step = 0; step < 3000; ++step) {
    sleep.begin(state, time(step), time(step + 1), std::vector<std::uint8_t>(2, 0), {});
    if (sleep.are_all_asleep()) return step;
    for (int v = 0; v < std::ssize(state.velocities); ++v)
      state.velocities[v] = common + Vec3(0, 0, v % every != 0 ? 0 : v % 2 == 0 ? shaking : -shaking);
    sleep.finish(kStep, {}, {}, state);
  }
  return 3000;
}

TEST(Sleep, ComesInTimeToAGroupThatTremblesInItsPlace) {
  EXPECT_EQ(steps_until_asleep(0.001, 0.01, Vec3::Zero()), 150);  // slow: half a second
  EXPECT_NEAR(steps_until_asleep(0.001, 0.1, Vec3::Zero()), 30 + 8 * 120, 10);
  EXPECT_NEAR(steps_until_asleep(0.001, 0.2, Vec3::Zero(), 26), 30 + 8 * 120, 10);  // a few vertices, however fast
  EXPECT_EQ(steps_until_asleep(0.001, 0.2, Vec3::Zero(), 3), 3000);
  EXPECT_EQ(steps_until_asleep(0.001, 0.1, Vec3(0.1, 0, 0)), 3000);  // slides
  EXPECT_EQ(steps_until_asleep(0.001, 0.3, Vec3::Zero()), 3000);     // too fast
  EXPECT_EQ(steps_until_asleep(1, 0.1, Vec3::Zero()), 3000);         // each alone: it swings
}

/// Part that the upper of two blocks keeps of its velocity in a quarter of a second, the first tenth as it is.
/// @param foot_stands      the lower does not move along
/// @param foot_is_carried  by a collider
double kept_velocity(bool foot_stands, bool foot_is_carried) {
  const Model model = make(std::vector{block(0.2, {0, 0, 0}), block(0.2, {0, 0, 0.201})}, rubber());
  State state = make_state(model, model.rest_positions);
  Sleep sleep(model, 0.015, Vec3(0, 0, -9.81));
  const Vec3 start(0.15, 0, 0);
  const auto foot = std::span(state.velocities).first(model.bodies[0].vertex_count);
  const std::vector<Index> carried(foot_is_carried ? 1 : 0, 0);
  std::fill(state.velocities.begin(), state.velocities.end(), start);
  for (int step = 0; step < 30 + 75; ++step) {
    const double now = step * kStep;
    sleep.begin(state, now, now + kStep, std::vector<std::uint8_t>(2, 0), {});
    if (foot_stands) std::fill(foot.begin(), foot.end(), Vec3::Zero());
    sleep.finish(kStep, {}, carried, state);
  }
  return state.velocities.back()[0] / start[0];
}

TEST(Sleep, StillsATowerThatSwaysAndNothingThatSlidesOrFalls) {
  // Half of the common velocity is the upper block's, and that is damped by 2/s.
  EXPECT_NEAR(kept_velocity(true, true) / kept_velocity(true, false), std::exp(-0.25), 0.02);
  EXPECT_NEAR(kept_velocity(false, true), 1, 1e-12);   // slides
  EXPECT_NEAR(kept_velocity(false, false), 1, 1e-12);  // falls
}

TEST(Sleep, OfOneHeapIsNoMatterOfAnotherFarAway) {
  Stage run(make(std::vector{block(0.2, {0, 0, 0.001}), block(0.2, {5, 0, 3})}, rubber()), sleeping(), {floor_at(0)});
  ASSERT_TRUE(run.run_until(1));
  const Vec3 before = run.state.positions[0];
  run.run(60);
  EXPECT_EQ(run.sleepers(), 1);
  EXPECT_EQ(run.state.positions[0], before);
  EXPECT_TRUE(run.run_until(2));
}

TEST(Sleep, WaitsForWhatPenetrates) {
  const Model model = make(std::vector{block(0.2, {0, 0, 0.001}), block(0.2, {0.05, 0.02, 0.1})}, rubber());
  Stage run(model, sleeping(), {floor_at(0)});
  ASSERT_TRUE(run.run_until(2));
  ContactFinder finder(model.mesh, {}, run.state.positions);
  finder.begin_step(run.state.positions);
  EXPECT_TRUE(finder.penetrating_vertices().empty());
}

TEST(Sleep, GivesTheSameBitsForAnyNumberOfThreadsAndFromAnyState) {
  const Model model = make(std::vector{block(0.2, {0, 0, 0.01}), block(0.2, {0.02, 0.03, 0.23})}, rubber());
  const auto run_whole = [&] {
    Stage heap(model, sleeping(), {floor_at(0)});
    EXPECT_TRUE(heap.run_until(2));
    heap.run(10);
    return heap.state;
  };
  const State whole = test::with_threads(1, run_whole);
  for (const int threads : {2, 4}) EXPECT_TRUE(same_bits(test::with_threads(threads, run_whole), whole)) << threads;
  // The second half by another solver: nothing is remembered but the state.
  Stage first(model, sleeping(), {floor_at(0)});
  first.run(static_cast<int>(whole.steps) - 60);
  Stage second(model, sleeping(), {floor_at(0)});
  second.state = first.state;
  second.run(60);
  EXPECT_TRUE(same_bits(second.state, whole));
  EXPECT_EQ(second.state.rest_times, whole.rest_times);
}

TEST(Sleep, RefusesImpossibleOptionsAndStates) {
  const Model model = make(block(0.2, {0, 0, 0}), rubber());
  XpbdOptions options = sleeping();
  options.sleep_speed = -1;
  expect_error("sleep speed: ", [&] { Stage(model, options, {}); });
  Stage run(model, sleeping(), {});
  run.state.rest_times = {0, 0};
  expect_error("state: 2 rest times for 1 bodies", [&] { run.solver.step(run.state); });
}

}  // namespace
}  // namespace selvage
