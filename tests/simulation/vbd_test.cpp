#include "selvage/simulation/vbd.h"

#include "selvage/simulation/newton.h"
#include "simulation/bodies.h"
#include "simulation/vbd/vertex_colours.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

VbdOptions without_contact_vbd(double time_step, int iterations) {
  VbdOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = time_step;
  options.iterations = iterations;
  return options;
}

TEST(VertexColours, ShareNoElementAndHoldEachVertexOfAnElementOnce) {
  IndexedMesh mesh = make_ball(0.1, 0.03);
  mesh.positions.push_back(Vec3::Zero());  // of no element
  const TetMesh tets(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  Model model;
  model.mesh = tets;
  const VertexColours colours = colour_vertices(model);
  std::vector<Index> colour_of(mesh.positions.size(), kNone);
  for (Index c = 0; c < colours.colour_count(); ++c)
    for (Index i = colours.first[c]; i < colours.first[c + 1]; ++i) {
      EXPECT_EQ(colour_of[colours.vertices[i]], kNone);
      colour_of[colours.vertices[i]] = c;
    }
  EXPECT_EQ(std::ssize(colours.vertices), std::ssize(mesh.positions) - 1);
  for (const auto& element : tets.elements())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) EXPECT_NE(colour_of[element[a]], colour_of[element[b]]);
  EXPECT_LE(colours.colour_count(), 16);
}

TEST(VbdSolver, LetsDampedBodiesFallFreely) {
  for (Material material : {neo_hookean(1e5), springs(1e-5, 1e-9)}) {
    material.damping = 0.1;
    const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), material);
    State state = make_state(model, model.rest_positions);
    VbdSolver solver(model, state, {}, {}, without_contact_vbd(0.01, 3));
    for (int i = 0; i < 20; ++i) solver.step(state);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      EXPECT_LT((state.positions[v] - model.rest_positions[v] - Vec3(0, 0, -9.81 * 210 * 1e-4)).norm(), 1e-12);
  }
}

// With many sweeps the step of VBD is that of Newton's method: both minimise the same potential.
TEST(VbdSolver, MinimisesWhatNewtonMinimises) {
  Material material = neo_hookean(2e4, 0.3);
  material.damping = 0.001;
  const Model model = make(make_box({0.3, 0.1, 0.1}, 0.05), material);
  Handle wall;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    if (model.rest_positions[v][0] < 0.001) wall.vertices.push_back(v);
  State by_vbd = make_state(model, model.rest_positions), by_newton = by_vbd, by_few = by_vbd;
  VbdSolver vbd(model, by_vbd, {wall}, {}, without_contact_vbd(0.02, 2000));
  VbdSolver few(model, by_vbd, {wall}, {}, without_contact_vbd(0.02, 5));
  NewtonOptions options;
  options.contact.mode = DetectionMode::kOff;
  options.time_step = 0.02;
  options.tolerance = 1e-9;
  options.newton_steps = 50;
  NewtonSolver newton(model, by_newton, {wall}, {}, options);
  for (int i = 0; i < 5; ++i) {
    vbd.step(by_vbd);
    few.step(by_few);
    newton.step(by_newton);
  }
  EXPECT_LT(vbd.statistics().residual, 1e-8);
  EXPECT_GT(few.statistics().residual, vbd.statistics().residual);
  double worst = 0, moved = 0;
  for (std::size_t v = 0; v < by_vbd.positions.size(); ++v) {
    worst = std::max(worst, (by_vbd.positions[v] - by_newton.positions[v]).norm());
    moved = std::max(moved, (by_vbd.positions[v] - model.rest_positions[v]).norm());
  }
  EXPECT_GT(moved, 0.02);
  EXPECT_LT(worst, 1e-6);
}

TEST(VbdSolver, StopsAtTheResidualThatIsAskedFor) {
  const Model model = make(make_box({0.2, 0.1, 0.1}, 0.05), neo_hookean(1e4));
  State state = make_state(model, model.rest_positions);
  VbdOptions options = without_contact_vbd(0.01, 1000);
  options.residual = 1e-6;
  Handle wall{{0, 1, 2, 3}};
  VbdSolver solver(model, state, {wall}, {}, options);
  solver.step(state);
  EXPECT_LE(solver.statistics().residual, 1e-6);
  EXPECT_LT(solver.statistics().newton_steps, 1000);
}

// Gaia's issue 11.
TEST(VbdSolver, BringsAStretchedCubeBackThatIsNearlyIncompressible) {
  for (const double cell : {0.1, 0.05}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, cell), neo_hookean(1e5, 0.4995));
    State state = make_state(model, model.rest_positions);
    for (Vec3& p : state.positions) p[0] *= 2;
    VbdOptions options = without_contact_vbd(1.0 / 300, 10);
    options.gravity.setZero();
    options.velocity_damping = 5;
    VbdSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 300; ++i) solver.step(state);
    EXPECT_EQ(inverted_elements(model, state), 0);
    EXPECT_LT(worst_stretch(model, state), 0.05) << cell;
  }
}

TEST(VbdSolver, SurvivesAViolentStartAndAStepOfASecond) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), neo_hookean(1e6, 0.45));
  for (const double time_step : {1.0 / 300, 1.0}) {
    State state = make_state(model, model.rest_positions);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      state.velocities[v] = 1000 * Vec3(std::sin(5 * v), std::cos(7 * v), std::sin(11 * v + 1));
    VbdOptions options = without_contact_vbd(time_step, 20);
    options.gravity.setZero();
    VbdSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 100; ++i) solver.step(state);
    for (const Vec3& p : state.positions) EXPECT_TRUE(p.allFinite());
  }
}

// All vertices of an element start in one point: its neighbours draw it out.
TEST(VbdSolver, DrawsAnElementOutOfAPoint) {
  const Model model = make(make_box({0.4, 0.2, 0.2}, 0.1), neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);
  const VertexTuple<4>& element = model.mesh.elements()[7];
  for (const Index v : element) state.positions[v] = model.rest_positions[element[0]];
  VbdOptions options = without_contact_vbd(1.0 / 60, 20);
  options.gravity.setZero();
  options.velocity_damping = 3;
  VbdSolver solver(model, state, {}, {}, options);
  for (int i = 0; i < 200; ++i) solver.step(state);
  EXPECT_EQ(inverted_elements(model, state), 0);
  EXPECT_LT(worst_stretch(model, state), 0.02);
}

TEST(VbdSolver, StandsAHeavyBodyOnALightOne) {
  expect_heavy_to_stand_on_light<VbdSolver>(VbdOptions(), 0.05, 0.05);
}

State run_vbd_pile(const Model& model, int restart = -1) {
  const State initial = make_state(model, model.rest_positions);
  State state = initial;
  const auto make_solver = [&] { return VbdSolver(model, initial, {{{0, 1, 2}, {}, 0.05}}, {{PlaneShape{}}}, {}); };
  VbdSolver solver = make_solver();
  std::int64_t contacts = 0;
  for (int i = 0; i < 50; ++i) {
    if (i == restart) solver = make_solver();
    solver.step(state);
    for (const std::int64_t count : solver.statistics().contact.contacts) contacts += count;
  }
  EXPECT_GT(contacts, 0);
  EXPECT_EQ(inverted_elements(model, state), 0);
  const BoundaryPathFinder<3> finder(model.mesh, state.positions);
  EXPECT_TRUE(finder.find_penetrating_vertices().empty());
  for (const Vec3& p : state.positions) EXPECT_GE(p[2], -1e-12);
  return state;
}

TEST(VbdSolver, KeepsBodiesApartWithTheSameBitsForAnyNumberOfThreadsAndWhenContinued) {
  const IndexedMesh ball = make_ball(0.1, 0.04);
  for (const Material& material : {neo_hookean(1e5), springs(1e-5, 1e-9)}) {
    const Model model =
        make(std::vector<IndexedMesh>{moved(ball, {0, 0, 0.101}), moved(ball, {0.02, 0, 0.305})}, material);
    const State expected = run_vbd_pile(model);
    for (const int threads : {1, 2, 4}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_TRUE(same_bits(run_vbd_pile(model), expected)) << threads;
    }
    EXPECT_TRUE(same_bits(run_vbd_pile(model, 40), expected));
  }
}

}  // namespace
}  // namespace selvage
