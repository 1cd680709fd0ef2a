// Cloth under XPBD: what it keeps, how it hangs, and that nothing crosses it.
#include "core/parallel.h"
#include "random.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/simulation/newton.h"
#include "simulation/bodies.h"
#include "simulation/cloth_bodies.h"
#include "simulation/guarded_steps.h"
#include "simulation/time_step/deformation_damping.h"

#include <tbb/global_control.h>

#include <numbers>

namespace selvage {
namespace {

using namespace bodies;

XpbdOptions guaranteed() {
  XpbdOptions options;
  options.time_step = 1.0 / 600;
  options.iterations = 10;
  options.contact.guarantee = true;
  return options;
}

TEST(Cloth, HasAThirdOfEachTriangleAtItsVertices) {
  const Model model = make_sheets({make_cloth(2, 1, 0.25)}, cloth());
  double all = 0;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) all += mass(model, v);
  EXPECT_NEAR(all, 2 * 0.2, 1e-14);
  EXPECT_EQ(model.mesh.element_count(), 0);
  EXPECT_EQ(surface_of(model).triangle_count(), std::ssize(model.triangles));
}

TEST(Cloth, FallsFreelyAsAPointDoes) {
  const Model model = make_sheets({make_cloth(1, 1, 0.25)}, cloth());
  State state = make_state(model, model.rest_positions);
  XpbdOptions options;
  options.time_step = 0.01;
  options.deformation_damping = 5;
  XpbdSolver solver(model, state, {}, {}, options);
  double speed = 0, fallen = 0;
  for (int i = 0; i < 50; ++i) {
    solver.step(state);
    speed -= 9.81 * 0.01;
    fallen += 0.01 * speed;
  }
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    EXPECT_NEAR((state.positions[v] - model.rest_positions[v] - Vec3(0, 0, fallen)).norm(), 0, 1e-12);
    EXPECT_NEAR((state.velocities[v] - Vec3(0, 0, speed)).norm(), 0, 1e-10);
  }
}

/// Largest changes of a crumpled sheet in flight, relative to the start, over a fifth of a second.
struct ClothDrift {
  double momentum = 0, spin = 0;
};
ClothDrift drift_of(const ClothMaterial& material, double time_step) {
  const Model model = make_sheets({make_cloth(1, 0.8, 0.1)}, material);
  State state = make_state(model, jittered(model.rest_positions, 0.005, 5));
  for (std::size_t v = 0; v < state.velocities.size(); ++v)
    state.velocities[v] = Vec3(1, 0, 2) + Vec3(0, 3, 1).cross(state.positions[v]);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  options.deformation_damping = 1;
  options.time_step = time_step;
  XpbdSolver solver(model, state, {}, {}, options);
  const Vec3 linear = momentum(model, state), spin = angular_momentum(model, state);
  ClothDrift drift;
  while (state.time < 0.2) {
    solver.step(state);
    drift.momentum = std::max(drift.momentum, (momentum(model, state) - linear).norm() / linear.norm());
    drift.spin = std::max(drift.spin, (angular_momentum(model, state) - spin).norm() / spin.norm());
  }
  return drift;
}

TEST(Cloth, KeepsMomentumAndSpin) {
  ClothMaterial damped = cloth();
  damped.damping = 0.01;
  for (const ClothMaterial& material : {cloth(), woven(), damped}) {
    const ClothDrift coarse = drift_of(material, 1.0 / 300), fine = drift_of(material, 1.0 / 1200);
    EXPECT_LT(coarse.momentum, 1e-11);
    EXPECT_LT(fine.momentum, 1e-11);
    EXPECT_LT(coarse.spin, 1e-11);
    EXPECT_LT(fine.spin, 1e-11);
  }
}

Model hanging_strip() {
  ClothMaterial material = woven();
  material.bending = 0;
  material.warp = material.weft = 50;
  return make_sheets({make_cloth(0.2, 1, 0.1)}, material);
}

TEST(Cloth, HangsByASumOfStretchesAsStiffAsItIs) {
  const Model model = hanging_strip();
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.time_step = 1.0 / 600;
  options.gravity = {0, -9.81, 0};
  options.iterations = 40;
  options.velocity_damping = 3;
  XpbdSolver solver(model, state, {hold(model, [](const Vec3& p) { return p[1] > 0.99; })}, {}, options);
  for (int i = 0; i < 3000; ++i) solver.step(state);
  double lowest = 1;
  for (const Vec3& p : state.positions) lowest = std::min(lowest, p[1]);
  // Of a strip of length 1: the weight below each place, over its stiffness. Masses are lumped in rows: that of the
  // last half row pulls, too.
  const double stretch = 0.2 * 9.81 / (2 * 50);
  EXPECT_NEAR(-lowest, stretch, 0.06 * stretch);
}

TEST(Cloth, HangsTheSameByNewtonsMethodInLargeSteps) {
  const Model model = hanging_strip();
  State state = make_state(model, model.rest_positions);
  NewtonOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = 1.0 / 30;
  options.gravity = {0, -9.81, 0};
  NewtonSolver solver(model, state, {hold(model, [](const Vec3& p) { return p[1] > 0.99; })}, {}, options);
  for (int i = 0; i < 150; ++i) solver.step(state);
  EXPECT_LT(solver.statistics().residual, 1e-6);
  double lowest = 1;
  for (const Vec3& p : state.positions) lowest = std::min(lowest, p[1]);
  const double stretch = 0.2 * 9.81 / (2 * 50);
  EXPECT_NEAR(-lowest, stretch, 0.02 * stretch);
}

TEST(Cloth, KeepsMomentumAndSpinByNewtonsMethod) {
  for (ClothMaterial material : {cloth(), woven()}) {
    material.damping = 0.01;
    const Model model = make_sheets({make_cloth(1, 0.8, 0.2)}, material);
    State state = make_state(model, jittered(model.rest_positions, 0.01, 5));
    for (std::size_t v = 0; v < state.velocities.size(); ++v)
      state.velocities[v] = Vec3(1, 0, 2) + Vec3(0, 3, 1).cross(state.positions[v]);
    NewtonOptions options;
    options.contact.mode = DetectionMode::kOff;
    options.gravity.setZero();
    options.tolerance = 1e-12;
    options.newton_steps = 100;
    const Vec3 linear = momentum(model, state), spin = angular_momentum(model, state);
    NewtonSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 10; ++i) solver.step(state);
    EXPECT_NEAR((momentum(model, state) - linear).norm(), 0, 1e-7 * linear.norm());
    // Forces act where the vertices end: their moment about where they start is not zero, by the step's first order.
    EXPECT_NEAR((angular_momentum(model, state) - spin).norm(), 0, 0.05 * spin.norm());
  }
}

TEST(Cloth, NothingMeetsByNewtonsMethodEither) {
  const IndexedMesh block = moved(make_box({0.4, 0.4, 0.2}, 0.2), {0.3, 0.3, -0.3});
  const std::vector<IndexedMesh> sheets{make_cloth(1, 1, 0.125), moved(make_cloth(1, 1, 0.125), {0.04, 0.03, 0.05})};
  const Model model = make_with_block(block, sheets, neo_hookean(1e5), cloth(0.005));
  State state = make_state(model, model.rest_positions);
  NewtonOptions options;
  options.time_step = 1.0 / 120;
  options.contact.guarantee = true;
  NewtonSolver solver(model, state, {}, {Collider{PlaneShape{{0, 0, -0.31}, Vec3::UnitZ()}, {}, {}}}, options);
  const ClothJudge judge(model);
  for (int i = 0; i < 60; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
  }
  EXPECT_TRUE(judge.is_free(state));
}

TEST(Cloth, ComesBackToItsShapeAtRestAlsoWhereThatIsBent) {
  IndexedMesh sheet = make_cloth(1, 0.4, 0.1);
  for (Vec3& p : sheet.positions) p = Vec3(std::cos(p[0]), p[1], std::sin(p[0]));  // a part of a tube
  ClothMaterial material = cloth();
  material.bending = 0.01;
  const Model model = make_sheets({sheet}, material);
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  options.velocity_damping = 2;
  options.iterations = 10;
  XpbdSolver solver(model, state, {}, {}, options);
  for (int i = 0; i < 20; ++i) solver.step(state);
  for (std::size_t v = 0; v < state.positions.size(); ++v)
    EXPECT_NEAR((state.positions[v] - model.rest_positions[v]).norm(), 0, 1e-9);
  for (Vec3& p : state.positions) p[2] *= 0.9;
  for (int i = 0; i < 2000; ++i) solver.step(state);
  for (const auto& [a, b, c] : model.triangles) {
    const double now = (state.positions[a] - state.positions[b]).norm();
    EXPECT_NEAR(now, (model.rest_positions[a] - model.rest_positions[b]).norm(), 1e-4);
  }
  const Index last = model.mesh.vertex_count() - 1;
  EXPECT_NEAR((state.positions[0] - state.positions[last]).norm(),
              (model.rest_positions[0] - model.rest_positions[last]).norm(), 2e-3);
}

TEST(Cloth, IsTheSameBitsForAnyNumberOfThreads) {
  const Model model =
      make_sheets({make_cloth(1, 1, 0.05), moved(make_cloth(1, 1, 0.05), {0.1, 0, 0.02})}, cloth(0.002));
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    State state = make_state(model, model.rest_positions);
    Collider ball{SphereShape{{0.5, 0.5, -0.3}, 0.25}, {}, {}};
    XpbdSolver solver(model, state, {}, {ball}, guaranteed());
    for (int i = 0; i < 60; ++i) solver.step(state);
    return state;
  };
  EXPECT_TRUE(same_bits(run(1), run(2)));
}

TEST(Cloth, LiesOnABall) {
  const Model model = make_sheets({make_cloth(1, 1, 0.1)}, cloth(0.005));
  State state = make_state(model, model.rest_positions);
  const Collider ball{SphereShape{{0.5, 0.5, -0.32}, 0.3}, {}, {}};
  XpbdOptions options = guaranteed();
  options.deformation_damping = 2;
  XpbdSolver solver(model, state, {}, {ball}, options);
  const ClothJudge judge(model);
  for (int i = 0; i < 400; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
  }
  EXPECT_LT(std::abs(centre(model, state)[0] - 0.5), 0.1);
  EXPECT_GT(centre(model, state)[2], -0.6);  // it has not slid off
  // Held off by half of its thickness, where it lies, and nowhere much nearer.
  double nearest = 1;
  for (const Vec3& p : state.positions) nearest = std::min(nearest, (p - Vec3(0.5, 0.5, -0.32)).norm() - 0.3);
  EXPECT_GT(nearest, 0.0025 - 1e-4);
  EXPECT_LT(nearest, 0.0025 + 1e-4);
}

TEST(Cloth, SheetsLieOnOneAnotherOnABlockOfElements) {
  // A soft block, two sheets over it: vertices, edges and faces of all of them meet.
  const IndexedMesh block = moved(make_box({0.4, 0.4, 0.2}, 0.1), {0.3, 0.3, -0.3});
  const std::vector<IndexedMesh> sheets{make_cloth(1, 1, 0.1), moved(make_cloth(1, 1, 0.1), {0.04, 0.03, 0.05})};
  const Model model = make_with_block(block, sheets, neo_hookean(1e5), cloth(0.005));
  State state = make_state(model, model.rest_positions);
  const Collider floor{PlaneShape{{0, 0, -0.31}, Vec3::UnitZ()}, {}, {}};
  XpbdSolver solver(model, state, {}, {floor}, guaranteed());
  const ClothJudge judge(model);
  std::int64_t near = 0;
  for (int i = 0; i < 300; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
    near += std::ssize(solver.contacts());
  }
  EXPECT_TRUE(judge.is_free(state));
  EXPECT_GT(near, 1000);
  const auto height = [&](Index body) {
    double sum = 0;
    for (Index v = 0; v < model.bodies[body].vertex_count; ++v)
      sum += state.positions[model.bodies[body].first_vertex + v][2];
    return sum / model.bodies[body].vertex_count;
  };
  EXPECT_GT(height(2), height(1));
  EXPECT_GT(height(1), -0.25);
}

TEST(Cloth, LeavesElementsInWhichItStarts) {
  const IndexedMesh block = make_box({0.4, 0.4, 0.4}, 0.1);
  const Model model =
      make_with_block(block, {moved(make_cloth(0.5, 0.4, 0.1), {0.35, 0.01, 0.21})}, neo_hookean(1e5), cloth());
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = guaranteed();
  options.gravity.setZero();
  XpbdSolver solver(model, state, {}, {}, options);
  solver.step(state);
  EXPECT_GT(solver.statistics().unguarded_vertices, 0);
  for (int i = 0; i < 200; ++i) solver.step(state);
  EXPECT_EQ(solver.statistics().unguarded_vertices, 0);
  EXPECT_TRUE(ClothJudge(model).is_free(state));
}

void expect_nothing_meets(std::uint64_t seed, std::int64_t& met, std::int64_t& held) {
  test::Random random(seed);
  const int count = 3 + static_cast<int>(random.below(3));
  auto [model, state] = make_flying_sheets(random, count);
  const ClothJudge judge(model);
  if (!judge.is_free(state)) return;
  XpbdSolver solver(model, state, {}, {Collider{PlaneShape{{0, 0, -1}, Vec3::UnitZ()}, {}, {}}}, guaranteed());
  expect_free_steps(judge, solver, state, 60, seed, met, held);
}

TEST(Cloth, NothingMeetsWhateverFliesAtWhat) {
  std::int64_t met = 0, held = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) expect_nothing_meets(seed, met, held);
  EXPECT_GT(met, 20);
  EXPECT_GT(held, 20);
}

TEST(Cloth, RefusesWhatIsNone) {
  IndexedMesh flat = make_cloth(1, 1, 0.5);
  flat.positions[0] = flat.positions[1];
  expect_error("triangle 1 of body 'sheet0': has no area at rest", [&] { make_sheets({flat}, cloth()); });
  expect_error("body 'sheet0': its thickness is 0.3 m, more than half of its shortest edge at rest, 0.5 m",
               [] { make_sheets({make_cloth(1, 1, 0.5)}, cloth(0.3)); });
  ClothMaterial light = cloth();
  light.density = 0;
  expect_error("body 'sheet0': its density is 0", [&] { make_sheets({make_cloth(1, 1, 0.5)}, light); });
}

}  // namespace
}  // namespace selvage
