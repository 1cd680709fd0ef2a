// Cloth by vertex block descent: against Newton's method on the same potential, and that nothing crosses it.
#include "core/parallel.h"
#include "random.h"
#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "simulation/cloth_bodies.h"
#include "simulation/cloth_pieces.h"
#include "simulation/guarded_steps.h"
#include "simulation/vbd/vertex_colours.h"
#include "test_scale.h"

#include <tbb/global_control.h>

namespace selvage {
namespace {

using namespace bodies;

VbdOptions vbd_without_contact(double time_step, int iterations) {
  VbdOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = time_step;
  options.iterations = iterations;
  return options;
}

VbdOptions guaranteed_vbd(double time_step) {
  VbdOptions options;
  options.time_step = time_step;
  options.contact.guarantee = true;
  return options;
}

NewtonOptions exact_newton(double time_step) {
  NewtonOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = time_step;
  options.tolerance = 1e-9;
  options.newton_steps = 100;
  return options;
}

/// All of what cloth is made of: damped, and bent over edges.
std::vector<ClothMaterial> stiff_materials() {
  std::vector<ClothMaterial> materials{cloth(), woven()};
  materials[0].stiffness = 200;
  materials[1].warp = 200;
  materials[1].weft = 100;
  materials[1].shear = 20;
  for (ClothMaterial& material : materials) {
    material.bending = 1e-3;
    material.damping = 0.002;
  }
  return materials;
}

IndexedMesh part_of_a_tube() {
  IndexedMesh sheet = make_cloth(1, 0.5, 0.125);
  for (Vec3& p : sheet.positions) p = Vec3(std::cos(p[0]), p[1], std::sin(p[0]));
  return sheet;
}

TEST(VbdCloth, ColoursShareNoElementTriangleOrHinge) {
  for (const double bending : {1e-4, 0.0}) {
    ClothMaterial material = cloth();
    material.bending = bending;
    const Model model =
        make_with_block(make_box({0.2, 0.2, 0.2}, 0.1), {make_cloth(1, 1, 0.1)}, neo_hookean(1e5), material);
    const VertexColours colours = colour_vertices(model);
    EXPECT_EQ(std::ssize(colours.vertices), model.mesh.vertex_count());
    const auto expect_apart = [&](std::span<const Index> vertices) {
      for (std::size_t a = 0; a < vertices.size(); ++a)
        for (std::size_t b = 0; b < a; ++b) EXPECT_NE(colours.of_vertex[vertices[a]], colours.of_vertex[vertices[b]]);
    };
    for (const auto& element : model.mesh.elements()) expect_apart(element);
    for (const auto& triangle : model.triangles) expect_apart(triangle);
    const std::vector<ClothHinge> hinges = list_cloth_hinges(model);
    EXPECT_EQ(hinges.empty(), bending == 0);
    for (const ClothHinge& hinge : hinges) expect_apart(hinge.vertices);
    EXPECT_LE(colours.colour_count(), 16);
  }
}

/// Farthest that two states are apart, and that the first is from rest.
struct Apart {
  double worst = 0, moved = 0;
};

Apart compare_steps(const Model& model, State start, const std::vector<Handle>& handles, double time_step, int steps) {
  State by_vbd = start, by_newton = start;
  VbdOptions options = vbd_without_contact(time_step, 5000);
  options.residual = 1e-9;
  VbdSolver vbd(model, start, handles, {}, options);
  NewtonSolver newton(model, start, handles, {}, exact_newton(time_step));
  Apart apart;
  for (int i = 0; i < steps; ++i) {
    vbd.step(by_vbd);
    newton.step(by_newton);
  }
  EXPECT_LE(vbd.statistics().residual, 1e-9);
  for (std::size_t v = 0; v < by_vbd.positions.size(); ++v) {
    apart.worst = std::max(apart.worst, (by_vbd.positions[v] - by_newton.positions[v]).norm());
    apart.moved = std::max(apart.moved, (by_vbd.positions[v] - start.positions[v]).norm());
  }
  return apart;
}

// With many sweeps a square that is held at its corners sags as by Newton's method until nothing changes.
TEST(VbdCloth, SagsAsByNewtonsMethod) {
  for (const ClothMaterial& material : stiff_materials()) {
    const Model model = make_sheets({make_cloth(1, 1, 0.125)}, material);
    const auto corners = [](const Vec3& p) { return std::abs(p[0] - 0.5) > 0.49 && std::abs(p[1] - 0.5) > 0.49; };
    const Apart apart =
        compare_steps(model, make_state(model, model.rest_positions), {hold(model, corners)}, 1.0 / 60, 5);
    EXPECT_GT(apart.moved, 0.03);
    EXPECT_LT(apart.worst, 1e-6);
  }
}

TEST(VbdCloth, BendsAsByNewtonsMethodAlsoWhereItIsBentAtRest) {
  for (const ClothMaterial& material : stiff_materials()) {
    const Model model = make_sheets({part_of_a_tube()}, material);
    const auto side = [](const Vec3& p) { return p[2] < 0.2; };
    const Apart apart = compare_steps(model, make_state(model, model.rest_positions), {hold(model, side)}, 1.0 / 60, 5);
    EXPECT_GT(apart.moved, 0.02);
    EXPECT_LT(apart.worst, 1e-6);
  }
}

TEST(VbdCloth, LeavesLessResidualWithMoreSweepsAndStopsWhereItIsSmall) {
  const Model model = make_sheets({make_cloth(1, 1, 0.125)}, cloth());
  const std::vector<Handle> side{hold(model, [](const Vec3& p) { return p[1] > 0.99; })};
  double last = std::numeric_limits<double>::infinity();
  for (const int sweeps : {5, 50, 500}) {
    State state = make_state(model, model.rest_positions);
    VbdSolver solver(model, state, side, {}, vbd_without_contact(1.0 / 120, sweeps));
    solver.step(state);
    EXPECT_EQ(solver.statistics().newton_steps, sweeps);
    EXPECT_GT(solver.statistics().residual, 0);
    EXPECT_LT(solver.statistics().residual, last);
    last = solver.statistics().residual;
  }
  State state = make_state(model, model.rest_positions);
  VbdOptions options = vbd_without_contact(1.0 / 120, 2000);
  options.residual = 2 * last;
  VbdSolver solver(model, state, side, {}, options);
  solver.step(state);
  EXPECT_LE(solver.statistics().residual, 2 * last);
  EXPECT_LT(solver.statistics().newton_steps, 501);
}

TEST(VbdCloth, KeepsMomentumAndFallsFreely) {
  for (ClothMaterial material : {cloth(), woven()}) {
    material.damping = 0.01;
    const Model model = make_sheets({make_cloth(1, 0.8, 0.2)}, material);
    State state = make_state(model, model.rest_positions);
    VbdSolver solver(model, state, {}, {}, vbd_without_contact(0.01, 3));
    for (int i = 0; i < 20; ++i) solver.step(state);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      EXPECT_LT((state.positions[v] - model.rest_positions[v] - Vec3(0, 0, -9.81 * 210 * 1e-4)).norm(), 1e-12);

    state = make_state(model, jittered(model.rest_positions, 0.01, 5));
    for (std::size_t v = 0; v < state.velocities.size(); ++v)
      state.velocities[v] = Vec3(1, 0, 2) + Vec3(0, 3, 1).cross(state.positions[v]);
    VbdOptions options = vbd_without_contact(1.0 / 300, 3000);
    options.gravity.setZero();
    const Vec3 linear = momentum(model, state);
    VbdSolver many(model, state, {}, {}, options);
    for (int i = 0; i < 3; ++i) many.step(state);
    EXPECT_NEAR((momentum(model, state) - linear).norm(), 0, 1e-7 * linear.norm());
  }
}

// Pressed and crumpled far beyond where a Newton step of a vertex is to be trusted: no step adds energy.
TEST(VbdCloth, SurvivesAViolentStartAndLosesEnergy) {
  for (const ClothMaterial& material : stiff_materials())
    for (const double time_step : {1.0 / 300, 1.0 / 30, 1.0}) {
      const Model model = make_sheets({make_cloth(1, 1, 0.125)}, material);
      State state = make_state(model, jittered(model.rest_positions, 0.2, 3));
      for (Index v = 0; v < model.mesh.vertex_count(); ++v)
        state.velocities[v] = 100 * Vec3(std::sin(5 * v), std::cos(7 * v), std::sin(11 * v + 1));
      VbdOptions options = vbd_without_contact(time_step, 20);
      options.gravity.setZero();
      VbdSolver solver(model, state, {}, {}, options);
      const double before = kinetic_energy(model, state);
      for (int i = 0; i < 40; ++i) solver.step(state);
      EXPECT_LT(kinetic_energy(model, state), 0.5 * before) << time_step;
      for (const Vec3& p : state.positions) EXPECT_TRUE(p.allFinite());
    }
}

TEST(VbdCloth, LiesOnABallHeldOffByHalfOfItsThickness) {
  const Model model = make_sheets({make_cloth(1, 1, 0.1)}, cloth(0.005));
  State state = make_state(model, model.rest_positions);
  const Vec3 centre_of_ball(0.5, 0.5, -0.32);
  const Collider ball{SphereShape{centre_of_ball, 0.3}, {}, {}};
  VbdSolver solver(model, state, {}, {ball}, guaranteed_vbd(1.0 / 240));
  const ClothJudge judge(model);
  for (int i = 0; i < 240; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
  }
  EXPECT_LT(std::abs(centre(model, state)[0] - 0.5), 0.1);
  EXPECT_GT(centre(model, state)[2], -0.6);  // it has not slid off
  double nearest = 1;
  for (const Vec3& p : state.positions) nearest = std::min(nearest, (p - centre_of_ball).norm() - 0.3);
  EXPECT_GT(nearest, 0.0025 - 1e-4);
  EXPECT_LT(nearest, 0.0025 + 1e-4);
}

TEST(VbdCloth, SheetsLieOnOneAnotherOnABlockOfElements) {
  const IndexedMesh block = moved(make_box({0.4, 0.4, 0.2}, 0.1), {0.3, 0.3, -0.3});
  const std::vector<IndexedMesh> sheets{make_cloth(1, 1, 0.1), moved(make_cloth(1, 1, 0.1), {0.04, 0.03, 0.05})};
  const Model model = make_with_block(block, sheets, neo_hookean(1e5), woven(0.005));
  State state = make_state(model, model.rest_positions);
  const Collider floor{PlaneShape{{0, 0, -0.31}, Vec3::UnitZ()}, {}, {}};
  VbdSolver solver(model, state, {}, {floor}, guaranteed_vbd(1.0 / 300));
  const ClothJudge judge(model);
  std::int64_t near = 0;
  const std::int64_t steps = test::scaled(200, 60);
  for (std::int64_t i = 0; i < steps; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
    near += std::ssize(solver.contacts());
  }
  EXPECT_TRUE(judge.is_free(state));
  EXPECT_GT(near, steps >= 200 ? 1000 : 0);
  const auto height = [&](Index body) {
    double sum = 0;
    for (Index v = 0; v < model.bodies[body].vertex_count; ++v)
      sum += state.positions[model.bodies[body].first_vertex + v][2];
    return sum / model.bodies[body].vertex_count;
  };
  EXPECT_GT(height(2), height(1));
  EXPECT_GT(height(1), -0.25);
}

template <typename Solver, typename Options>
void expect_sheets_part(Options options) {
  options.contact.guarantee = true;
  options.time_step = 1.0 / 300;
  options.gravity = Vec3::Zero();
  const double thickness = 0.005;
  const Model model = make_sheets({make_cloth(1, 1, 0.1), moved(make_cloth(1, 1, 0.1), {0.04, 0.03, 0.2 * thickness})},
                                  woven(thickness));
  State state = make_state(model, model.rest_positions);
  Solver solver(model, state, {}, {}, options);
  const ClothJudge judge(model);
  for (int i = 0; i < 40; ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
    EXPECT_EQ(solver.statistics().held_back_vertices, 0);
  }
  double least = 1, most = -1;
  for (Index v = 0; v < model.bodies[1].vertex_count; ++v) {
    const Vec3& p = state.positions[model.bodies[1].first_vertex + v];
    if (p[0] > 0.95 || p[1] > 0.95) continue;
    least = std::min(least, p[2]);
    most = std::max(most, p[2]);
  }
  const double below = centre(model, state)[2];
  EXPECT_GT(2 * (least - below), 0.9 * thickness);
  EXPECT_LT(2 * (most - below), 20 * thickness);
}

TEST(VbdCloth, SheetsThatAreNearerThanTheirThicknessPart) {
  expect_sheets_part<VbdSolver>(VbdOptions{});
  expect_sheets_part<NewtonSolver>(NewtonOptions{});
}

/// Sweeps are few and steps are long, so that the gate at the end of a step has something to hold back.
void expect_nothing_meets(std::uint64_t seed, std::int64_t& met, std::int64_t& held) {
  test::Random random(seed);
  auto [model, state] = make_flying_sheets(random, 3);
  const ClothJudge judge(model);
  if (!judge.is_free(state)) return;
  VbdOptions options = guaranteed_vbd(random.below(2) == 0 ? 1.0 / 300 : 1.0 / 60);
  options.iterations = 1 + static_cast<int>(random.below(5));
  VbdSolver solver(model, state, {}, {Collider{PlaneShape{{0, 0, -1}, Vec3::UnitZ()}, {}, {}}}, options);
  expect_free_steps(judge, solver, state, 30, seed, met, held);
}

TEST(VbdCloth, NothingMeetsWhateverFliesAtWhat) {
  std::int64_t met = 0, held = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) expect_nothing_meets(seed, met, held);
  EXPECT_GT(met, 0);
  EXPECT_GT(held, 0);
}

TEST(VbdCloth, IsTheSameBitsForAnyNumberOfThreadsAndWhenContinued) {
  const Model model =
      make_sheets({make_cloth(1, 1, 0.08), moved(make_cloth(1, 1, 0.08), {0.1, 0, 0.02})}, cloth(0.002));
  const auto run = [&](std::size_t threads, int restart) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const State initial = make_state(model, model.rest_positions);
    State state = initial;
    const Collider ball{SphereShape{{0.5, 0.5, -0.3}, 0.25}, {}, {}};
    const auto make_solver = [&] { return VbdSolver(model, initial, {}, {ball}, guaranteed_vbd(1.0 / 200)); };
    VbdSolver solver = make_solver();
    for (int i = 0; i < 30; ++i) {
      if (i == restart) solver = make_solver();
      solver.step(state);
    }
    return state;
  };
  const State expected = run(1, -1);
  for (const std::size_t threads : {2, 4}) EXPECT_TRUE(same_bits(run(threads, -1), expected)) << threads;
  EXPECT_TRUE(same_bits(run(2, 17), expected));
}

}  // namespace
}  // namespace selvage
