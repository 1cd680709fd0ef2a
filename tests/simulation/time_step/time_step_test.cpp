// The part of a step that all solvers share, under the smallest solver of all: one without a material.
#include "simulation/time_step/time_step.h"

#include "selvage/core/error.h"
#include "simulation/bodies.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// Vertices that know nothing of one another.
class DustSolver {
 public:
  DustSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::span<const Collider> colliders,
             const StepOptions& options)
      : time_step_(model, initial, std::move(handles), colliders, options) {}

  void step(State& state, std::span<const Vec3> external_forces = {}) {
    time_step_.begin(state, external_forces);
    time_step_.find_contacts();
    time_step_.project_colliders();
    time_step_.finish(state);
  }
  TimeStep& time_step() { return time_step_; }

 private:
  TimeStep time_step_;
};

const IndexedMesh kBox = make_box({0.2, 0.2, 0.2}, 0.1);

TEST(TimeStep, LetsVerticesFallByTheirVelocityGravityAndForces) {
  const Model model = make(kBox, neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  std::vector<Vec3> forces;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    state.velocities[v] = Vec3(v, 0, 1);
    forces.push_back(mass(model, v) * Vec3(0, 2, 0));
  }
  StepOptions options;
  options.time_step = 0.01;
  options.gravity = Vec3(0, 0, -10);
  DustSolver solver(model, state, {}, {}, options);
  solver.step(state, forces);
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    ASSERT_LT((state.velocities[v] - Vec3(v, 0.02, 0.9)).norm(), 1e-11 * (1 + v));
    ASSERT_LT((state.positions[v] - model.rest_positions[v] - 0.01 * state.velocities[v]).norm(), 1e-15 * (1 + v));
  }
  EXPECT_EQ(state.steps, 1);
  EXPECT_EQ(state.time, 0.01);
  EXPECT_THROW(solver.step(state, std::span(forces).first(3)), Error);
  EXPECT_EQ(state.steps, 1);
}

TEST(TimeStep, MovesVerticesOfAHandleByItsMotionAndTakesTheirInverseMass) {
  const Model model = make(kBox, neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  Handle handle{.vertices = {0, 5}, .motion = {}, .release_time = 0.025};
  handle.motion.keyframes = {{0, Vec3::Zero()}, {1, Vec3(1, 0, 0)}};
  StepOptions options;
  options.time_step = 0.01;
  DustSolver solver(model, state, {handle}, {}, options);
  for (int i = 1; i <= 4; ++i) {
    solver.step(state);
    const bool is_held = i <= 3;  // the last step begins after the release
    for (const Index v : handle.vertices) {
      EXPECT_EQ(solver.time_step().vertices()[v].inverse_mass > 0, !is_held);
      const Vec3 expected = model.rest_positions[v] + Vec3(0.01 * i, 0, is_held ? 0 : -9.81e-4);
      EXPECT_LT((state.positions[v] - expected).norm(), 1e-15) << i;
    }
  }
}

// One collider is asked of each vertex, several of many vertices at a time: that makes no difference.
TEST(TimeStep, PassesByCollidersThatMoveManyVerticesAtATimeWithoutMissingAny) {
  const Model model = make(make_box({1, 1, 1}, 0.1), neo_hookean(1e5));
  Motion motion;
  motion.keyframes = {{0, Vec3::Zero()}, {0.1, Vec3(0.3, 0.1, 0.4), 0.7}, {0.2, Vec3(-0.2, 0, 0.6), -0.5}};
  motion.axis = Vec3(1, 2, 3);
  motion.centre = Vec3(0.5, 0.4, 0.1);
  const Collider colliders[] = {
      {PlaneShape{Vec3(0, 0, -0.2), Vec3(0.1, 0, 1)}, motion, {0.5, 0.4}},
      {Bowl{Vec3(0.5, 0.5, 0.4), Vec3::UnitZ(), 0.8}, motion, {0.5, 0.4}},
      {SphereShape{Vec3(0.3, 0.2, -0.3), 0.35}, motion, {0.5, 0.4}},
      {CylinderShape{Vec3(0.6, 0.5, -0.3), Vec3::UnitX(), 0.2, 1.5}, motion, {0.5, 0.4}},
  };
  const Collider far{PlaneShape{Vec3(0, 0, -100)}, {}, {0, 0}};
  StepOptions options;
  options.time_step = 0.01;
  options.contact.mode = DetectionMode::kOff;
  for (const Collider& collider : colliders) {
    State alone = make_state(model, model.rest_positions), beside = alone, free = alone;
    DustSolver one(model, alone, {}, std::array{collider}, options);
    DustSolver two(model, beside, {}, std::array{collider, far}, options);
    DustSolver none(model, free, {}, {}, options);
    for (int step = 0; step < 25; ++step) {
      one.step(alone);
      two.step(beside);
      none.step(free);
      ASSERT_EQ(alone.positions, beside.positions) << step;
    }
    EXPECT_NE(alone.positions, free.positions);
  }
}

/// Out of a collider that stands still by a twentieth of their depth a step, out of one that moves by a quarter of an
/// edge, and by neither with a speed.
TEST(TimeStep, BringsVerticesThatStartInCollidersOutWithoutSpeed) {
  const Model model = make(kBox, neo_hookean(1e5));
  StepOptions options;
  options.gravity.setZero();
  const auto expect_surfaces = [&](const Motion& motion, const std::array<double, 2>& surfaces) {
    State state = make_state(model, model.rest_positions);
    const std::array floor{Collider{PlaneShape{Vec3(0, 0, 0.05)}, motion, {0, 0}}};
    DustSolver solver(model, state, {}, floor, options);
    for (const double surface : surfaces) {
      solver.step(state);
      std::int64_t below = 0;
      for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
        below += model.rest_positions[v][2] < surface;
        EXPECT_NEAR(state.positions[v][2], std::max(model.rest_positions[v][2], surface), 1e-15);
        EXPECT_LT(state.velocities[v].norm(), 1e-12);
      }
      EXPECT_GT(below, 0);
      EXPECT_EQ(solver.time_step().statistics().collider_contacts, below);
    }
  };
  expect_surfaces({}, {0.05 * 0.05, 0.05 * (1 - 0.95 * 0.95)});
  Motion along;
  along.keyframes = {{.time = 0}, {.time = 1, .translation = Vec3(1, 0, 0)}};
  expect_surfaces(along, {0.025, 0.05});  // edges are 0.1 m long
}

TEST(TimeStep, FindsContactsFromTheStartOfTheStepToWhereVerticesAre) {
  const Model model = make(std::array{kBox, moved(kBox, {0.05, 0.03, 0.21})}, neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  for (Index v = model.bodies[1].first_vertex; v < model.mesh.vertex_count(); ++v)
    state.velocities[v] = Vec3(0, 0, -6);  // 0.02 m, where the gap is half of that
  StepOptions options;
  options.contact.hold_back = false;
  DustSolver solver(model, state, {}, {}, options);
  solver.step(state);
  EXPECT_FALSE(solver.time_step().contacts().empty());
  for (const Contact& contact : solver.time_step().contacts()) EXPECT_LT(gap_of(contact, state.positions), 0);
}

TEST(TimeStep, KeepsTheStateWhereAVertexIsNotFinite) {
  const Model model = make(kBox, neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);
  const State before = state;
  TimeStep time_step(model, state, {}, {}, without_contact());
  time_step.begin(state, {});
  time_step.vertices()[7].position[1] = NAN;
  EXPECT_THROW(time_step.find_contacts(), Error);
  EXPECT_THROW(time_step.finish(state), Error);
  EXPECT_EQ(state.positions, before.positions);
  EXPECT_EQ(state.steps, 0);
}

/// A thousand times as far as all bodies are large, as solvers that diverge do; inertia may take vertices anywhere.
TEST(TimeStep, RefusesWhatTheSolverThrowsAndNotWhatFliesFast) {
  const Model model = make(kBox, neo_hookean(1e5));
  const double size = Vec3(0.2, 0.2, 0.2).norm();
  const auto end_of = [&](double speed, double thrown) {
    State state = make_state(model, model.rest_positions);
    for (Vec3& v : state.velocities) v = Vec3(speed, 0, 0);
    TimeStep time_step(model, state, {}, {}, without_contact());
    time_step.begin(state, {});
    time_step.vertices()[7].position[1] += thrown;
    time_step.finish(state);
    return state.positions[7];
  };
  EXPECT_EQ(end_of(0, 999 * size)[1], model.rest_positions[7][1] + 999 * size);
  EXPECT_GT(end_of(1e9, 0)[0], 1e6);
  try {
    end_of(0, 1001 * size);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("vertex 7: the solver throws it by 3.5e+02 m in step 1"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace selvage
