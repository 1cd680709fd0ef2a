#include "selvage/simulation/newton.h"

#include "simulation/bodies.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

#include <random>

namespace selvage {
namespace {

using namespace bodies;

NewtonOptions without_contact_newton(double time_step = 1.0 / 300) {
  NewtonOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = time_step;
  return options;
}

TEST(NewtonSolver, LetsDampedBodiesFallFreely) {
  for (const Material& material : {damped(neo_hookean(1e5), 0.1), damped(springs(1e-5, 1e-9), 0.1)}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), material);
    State state = make_state(model, model.rest_positions);
    for (Vec3& v : state.velocities) v = Vec3(1, 2, 3);
    NewtonOptions options = without_contact_newton(0.01);
    options.linear_solver = LinearSolver::kDirect;
    NewtonSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 20; ++i) solver.step(state);
    const Vec3 fallen = 0.2 * Vec3(1, 2, 3) + 210 * 1e-4 * Vec3(0, 0, -9.81);  // sum of i h^2 g
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      EXPECT_LT((state.positions[v] - model.rest_positions[v] - fallen).norm(), 1e-12);
  }
}

// Damping changes neither momentum nor, beyond backward Euler's own loss, angular momentum.
TEST(NewtonSolver, KeepsMomentumAndTheAngularMomentumOfTheUndampedBody) {
  Vec3 spins[2];
  for (const bool with_damping : {false, true}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), damped(neo_hookean(1e6), with_damping ? 0.05 : 0));
    State state = make_state(model, model.rest_positions);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      state.velocities[v] = Vec3(1, 0, 0) + Vec3(0, 1, 2).cross(model.rest_positions[v]);
    NewtonOptions options = without_contact_newton(0.001);
    options.gravity.setZero();
    options.tolerance = 1e-9;
    options.linear_solver = LinearSolver::kDirect;
    const Vec3 momentum_before = momentum(model, state), spin_before = angular_momentum(model, state);
    NewtonSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 50; ++i) solver.step(state);
    EXPECT_LT((momentum(model, state) - momentum_before).norm(), 1e-9 * momentum_before.norm());
    spins[with_damping] = angular_momentum(model, state);
    EXPECT_LT((spins[with_damping] - spin_before).norm(), 0.02 * spin_before.norm());
  }
  EXPECT_LT((spins[1] - spins[0]).norm(), 1e-4 * spins[0].norm());
}

TEST(NewtonSolver, HangsABeamWhereManySmallStepsOfXpbdHangIt) {
  const Model model = make(make_box({0.1, 0.1, 0.5}, 0.05), neo_hookean(2e5, 0.3));
  State state = make_state(model, model.rest_positions);
  NewtonOptions options = without_contact_newton(0.1);
  options.tolerance = 1e-8;
  options.newton_steps = 30;
  NewtonSolver solver(model, state, {hold(model, [](const Vec3& p) { return p[2] > 0.499; })}, {}, options);
  for (int i = 0; i < 100; ++i) solver.step(state);
  double lowest = 0;
  for (const Vec3& p : state.positions) lowest = std::min(lowest, p[2]);
  const double expected = 1000 * 9.81 * 0.25 / (2 * 2e5);  // rho g L^2 / (2 E)
  EXPECT_NEAR(-lowest, expected, 0.03 * expected);
  for (const Vec3& v : state.velocities) EXPECT_LT(v.norm(), 1e-6);
  EXPECT_LT(solver.statistics().residual, 1e-6);
}

// A beam held at one end comes to the same rest with steps of any length: at rest nothing depends on the step.
TEST(NewtonSolver, ComesToTheSameRestWithAnyStep) {
  const Model model = make(make_box({0.4, 0.1, 0.1}, 0.05), neo_hookean(1e5, 0.4));
  const Handle wall = hold(model, [](const Vec3& p) { return p[0] < 0.001; });
  std::vector<State> rests;
  for (const double time_step : {0.1, 1.0}) {
    State state = make_state(model, model.rest_positions);
    NewtonOptions options = without_contact_newton(time_step);
    options.tolerance = 1e-9;
    options.newton_steps = 100;
    NewtonSolver solver(model, state, {wall}, {}, options);
    for (int i = 0; i < (time_step < 1 ? 150 : 40); ++i) solver.step(state);
    rests.push_back(state);
    EXPECT_EQ(inverted_elements(model, state), 0);
  }
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    EXPECT_LT((rests[0].positions[v] - rests[1].positions[v]).norm(), 1e-5);
  EXPECT_LT(rests[0].positions.back()[2], 0.08);  // it has sagged
}

// Gaia's issue 11: a stretched cube that is let go gets worse as it is closer to incompressible, and as it is finer.
TEST(NewtonSolver, BringsStretchedCubesBackThatAreNearlyIncompressible) {
  for (const double cell : {0.1, 0.05}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, cell), neo_hookean(1e5, 0.4995));
    State state = make_state(model, model.rest_positions);
    for (Vec3& p : state.positions) p[0] *= 2;
    NewtonOptions options = without_contact_newton(1.0 / 60);
    options.gravity.setZero();
    options.newton_steps = 50;
    NewtonSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 90; ++i) solver.step(state);
    EXPECT_EQ(inverted_elements(model, state), 0);
    EXPECT_LT(worst_stretch(model, state), 0.01) << cell;
  }
}

TEST(NewtonSolver, RecoversFromFlatMirroredAndCollapsedStarts) {
  for (const double youngs_modulus : {1e5, 1e8}) {
    const Model model = make(make_box({0.4, 0.2, 0.2}, 0.1), neo_hookean(youngs_modulus, 0.4));
    for (const int tangle : {0, 1, 2, 3}) {
      State state = make_state(model, model.rest_positions);
      for (Vec3& p : state.positions) {
        if (tangle == 0) p[2] *= 1e-3;
        if (tangle == 1) p = jittered(std::span(&p, 1), 0.2, static_cast<unsigned>(1e4 * p.sum()))[0];
      }
      // All vertices of an element in one point.
      if (tangle == 2)
        for (const Index v : model.mesh.elements()[7])
          state.positions[v] = model.rest_positions[model.mesh.elements()[7][0]];
      if (tangle == 3)
        for (Vec3& p : state.positions) p[2] = 0;
      NewtonOptions options = without_contact_newton(1.0 / 60);
      options.gravity.setZero();
      options.velocity_damping = 3;
      NewtonSolver solver(model, state, {}, {}, options);
      for (int i = 0; i < 200; ++i) solver.step(state);
      for (const Vec3& p : state.positions) ASSERT_TRUE(p.allFinite());
      if (tangle == 3) continue;  // by symmetry a flat body stays flat
      EXPECT_EQ(inverted_elements(model, state), 0) << tangle << ", " << youngs_modulus;
      EXPECT_LT(worst_stretch(model, state), 0.02) << tangle << ", " << youngs_modulus;
    }
  }
}

TEST(NewtonSolver, SurvivesAViolentStartAndAStepOfASecond) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), neo_hookean(1e6, 0.45));
  for (const double time_step : {1.0 / 300, 1.0}) {
    State state = make_state(model, model.rest_positions);
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> unit(-1000, 1000);
    for (Vec3& v : state.velocities) v = Vec3(unit(engine), unit(engine), unit(engine));
    NewtonOptions options = without_contact_newton(time_step);
    options.gravity.setZero();
    options.newton_steps = 100;
    NewtonSolver solver(model, state, {}, {}, options);
    const double before = kinetic_energy(model, state);
    for (int i = 0; i < 100; ++i) {
      solver.step(state);
      ASSERT_LT(kinetic_energy(model, state), before) << i;
    }
    if (time_step > 0.5) {
      EXPECT_LT(worst_stretch(model, state), 0.01);
    }
  }
}

State run_newton_pile(const Model& model, int steps, LinearSolver linear_solver, int restart = -1) {
  const State initial = make_state(model, model.rest_positions);
  State state = initial;
  Handle handle{{0, 1, 2}, {}, 0.05};
  NewtonOptions options;
  options.time_step = 1.0 / 120;
  options.linear_solver = linear_solver;
  const auto make_solver = [&] { return NewtonSolver(model, initial, {handle}, {{PlaneShape{}}}, options); };
  NewtonSolver solver = make_solver();
  std::int64_t contacts = 0;
  for (int i = 0; i < steps; ++i) {
    if (i == restart) solver = make_solver();
    solver.step(state);
    for (const std::int64_t count : solver.statistics().contact.contacts) contacts += count;
  }
  EXPECT_GT(contacts, 0);
  return state;
}

TEST(NewtonSolver, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const Material& material : {damped(neo_hookean(1e5), 0.001), damped(springs(1e-5, 1e-9), 0.001)}) {
    const Model model = pile(material);
    for (const LinearSolver linear_solver : {LinearSolver::kConjugateGradients, LinearSolver::kDirect}) {
      const State expected = run_newton_pile(model, 20, linear_solver);
      for (const int threads : {1, 3}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_TRUE(same_bits(run_newton_pile(model, 20, linear_solver), expected)) << threads;
      }
    }
  }
}

TEST(NewtonSolver, GivesTheSameBitsWhenContinuedFromAState) {
  const Model model = pile(neo_hookean(1e5));
  for (const LinearSolver linear_solver : {LinearSolver::kConjugateGradients, LinearSolver::kDirect})
    EXPECT_TRUE(same_bits(run_newton_pile(model, 20, linear_solver, 16), run_newton_pile(model, 20, linear_solver)));
}

TEST(NewtonSolver, KeepsBodiesApart) {
  const Model model = pile(damped(neo_hookean(1e5), 0.002));
  State state = make_state(model, model.rest_positions);
  NewtonOptions options;
  options.time_step = 1.0 / 120;
  options.velocity_damping = 1;
  NewtonSolver solver(model, state, {}, {{PlaneShape{}}}, options);
  std::int64_t held_back = 0;
  for (int i = 0; i < 60; ++i) {
    solver.step(state);
    held_back += solver.statistics().held_back_vertices;
    for (const Vec3& p : state.positions) ASSERT_GE(p[2], -1e-12);
  }
  EXPECT_EQ(inverted_elements(model, state), 0);
  const BoundaryPathFinder<3> finder(model.mesh, state.positions);
  EXPECT_TRUE(finder.find_penetrating_vertices().empty());
  EXPECT_LT(held_back, 200);
}

/// How far a block slides on a slope of 25 degrees (of tangent 0.466) in 0.3 s, by its speed then [m/s].
double slide_by_newton(double friction, bool on_collider) {
  const IndexedMesh slope = moved(make_box({0.6, 0.3, 0.05}, 0.05), {-0.2, -0.075, -0.0501});
  const IndexedMesh block = make_box({0.15, 0.15, 0.08}, 0.04);
  const Model model = on_collider ? make(block, neo_hookean(1e5, 0.3))
                                  : make(std::vector<IndexedMesh>{slope, block}, neo_hookean(1e5, 0.3));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(25 * M_PI / 180, Vec3::UnitY()).toRotationMatrix();
  State state = make_state(model, model.rest_positions);
  for (Vec3& p : state.positions) p = turn * p;
  Handle held;
  if (!on_collider)
    for (Index v = 0; v < model.bodies[0].vertex_count; ++v) held.vertices.push_back(v);
  NewtonOptions options;
  options.friction = {friction, friction};
  std::vector<Collider> colliders;
  if (on_collider) colliders.push_back({PlaneShape{Vec3::Zero(), turn * Vec3::UnitZ()}, {}, {friction, friction}});
  NewtonSolver solver(model, state, {held}, colliders, options);
  for (int i = 0; i < 90; ++i) solver.step(state);
  return (momentum(model, state) / (1000 * 0.15 * 0.15 * 0.08)).dot(turn * Vec3::UnitX());
}

TEST(NewtonSolver, HoldsABlockByFrictionAndLetsItSlideByCoulombsLaw) {
  for (const bool on_collider : {false, true}) {
    EXPECT_NEAR(slide_by_newton(0.6, on_collider), 0, 0.02) << on_collider;
    const double free = 9.81 * std::sin(25 * M_PI / 180) * 0.3, braked = 9.81 * std::cos(25 * M_PI / 180) * 0.3;
    EXPECT_NEAR(slide_by_newton(0, on_collider), free, 0.06 * free) << on_collider;
    EXPECT_NEAR(slide_by_newton(0.2, on_collider), free - 0.2 * braked, 0.08 * free) << on_collider;
  }
}

TEST(NewtonSolver, StandsAHeavyBodyOnALightOne) {
  expect_heavy_to_stand_on_light<NewtonSolver>(NewtonOptions(), 0.06, 0.01);
}

TEST(NewtonSolver, RefusesImpossibleInputAndNamesIt) {
  const IndexedMesh box = make_box({0.2, 0.2, 0.2}, 0.1);
  const Model model = make(box, neo_hookean(1e5)), rigid = make(box, springs(0, 1e-9));
  const State state = make_state(model, model.rest_positions);
  NewtonOptions options;
  expect_error("body 'body0'", [&] { NewtonSolver(rigid, state, {}, {}, options); });
  options.newton_steps = 0;
  expect_error("newton steps", [&] { NewtonSolver(model, state, {}, {}, options); });
  options = {};
  options.linear_tolerance = 1;
  expect_error("linear tolerance", [&] { NewtonSolver(model, state, {}, {}, options); });
  options = {};
  options.tolerance = -1;
  expect_error("tolerance", [&] { NewtonSolver(model, state, {}, {}, options); });
}

TEST(NewtonSolver, KeepsTheStateOfBeforeAStepThatFails) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  NewtonSolver solver(model, state, {}, {}, {});
  solver.step(state);
  state.velocities[5] = Vec3(0, 1e308, 0);
  state.velocities[5] *= 10;
  const State before = state;
  expect_error("vertex ", [&] { solver.step(state); });
  EXPECT_EQ(state.positions, before.positions);
  EXPECT_EQ(state.steps, before.steps);
}

}  // namespace
}  // namespace selvage
