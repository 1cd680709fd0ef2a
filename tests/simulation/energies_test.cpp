// What statistics say of energies: measured on the state alone, alike for all solvers.
#include "simulation/implicit/energies.h"

#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "simulation/cloth_bodies.h"
#include "simulation/implicit/incremental_potential.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

const Vec3 kGravity(0, 0, -9.81);

double elastic_energy(const Model& model, std::span<const Vec3> positions) {
  State state = make_state(model, model.rest_positions);
  state.positions.assign(positions.begin(), positions.end());
  return EnergyMeasure(model).measure(state, kGravity, measure_solids(model, positions)).elastic;
}

TEST(Energies, OfAStretchedBlockIsTheFormulaOfItsMaterial) {
  const double stretch = 1.3, mu = 1e4 / (2 * 1.4), lambda = 1e4 * 0.4 / (1.4 * 0.2);
  const Model model = make(make_box({0.3, 0.2, 0.1}, 0.1), neo_hookean(1e4, 0.4));
  State state = make_state(model, model.rest_positions);
  for (Vec3& p : state.positions) p[0] *= stretch;
  const double growth = stretch - 1;
  const double density = mu / 2 * (stretch * stretch - 1) - mu * growth + (lambda + mu) / 2 * growth * growth;
  EXPECT_NEAR(elastic_energy(model, state.positions), 0.3 * 0.2 * 0.1 * density, 1e-12 * density);
  EXPECT_NEAR(elastic_energy(model, model.rest_positions), 0, 1e-12 * density);
}

TEST(Energies, OfMassSpringsAreThoseOfEdgesAndVolumesThatAreNotRigid) {
  IndexedMesh tet;
  tet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tet.tetrahedra = {{0, 1, 2, 3}};
  std::vector<Vec3> twice = tet.positions;
  for (Vec3& p : twice) p *= 2;
  const double edges = (3 * 1.0 + 3 * 2.0) / 2, volume = 49.0 / 72;  // per 1/compliance: half of changes squared
  EXPECT_NEAR(elastic_energy(make(tet, springs(0.5, 0.25)), twice), edges / 0.5 + volume / 0.25, 1e-12);
  EXPECT_NEAR(elastic_energy(make(tet, springs(0.5, 0)), twice), edges / 0.5, 1e-12);
  EXPECT_NEAR(elastic_energy(make(tet, springs(0, 0.25)), twice), volume / 0.25, 1e-12);
}

TEST(Energies, AreWhatTheImplicitSolversMinimiseButForInertia) {
  const IndexedMesh block = make_box({0.2, 0.2, 0.2}, 0.1), sheet = make_cloth(0.4, 0.4, 0.1);
  Material solid = damped(neo_hookean(1e4), 0.01);
  ClothMaterial material = woven();
  material.bending = 1e-3;
  material.damping = 0.01;
  const Model model = make_with_block(block, {moved(sheet, {0, 0, 0.5})}, solid, material);
  const std::vector<Vec3> x = jittered(model.rest_positions, 0.02, 5), velocities(x.size(), Vec3::Zero());
  IncrementalPotential potential(model, 0.01);
  std::vector<StepVertex> vertices;
  for (std::size_t v = 0; v < x.size(); ++v) vertices.push_back({{x[v][0], x[v][1], x[v][2]}, model.inverse_masses[v]});
  // From here to here inertia and damping cost nothing.
  potential.begin(Step{1, 0, 0.01, x, velocities}, vertices);
  const double expected = potential.energy(x);
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(elastic_energy(model, x), expected, 1e-12 * expected);
}

TEST(Energies, OfMotionAndWeightLeaveOutWhatIsPinned) {
  Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), neo_hookean(1e4));
  State state = make_state(model, model.rest_positions);
  for (Vec3& v : state.velocities) v = Vec3(0, 3, 4);
  const EnergyMeasure measure(model);
  const double mass = 8;
  Energies energies = measure.measure(state, kGravity, measure_solids(model, state.positions));
  EXPECT_NEAR(energies.kinetic, 0.5 * mass * 25, 1e-11);
  EXPECT_NEAR(energies.gravity, mass * 9.81 * centre(model, state)[2], 1e-11);
  for (double& inverse_mass : model.inverse_masses) inverse_mass = 0;
  energies = measure.measure(state, kGravity, measure_solids(model, state.positions));
  EXPECT_EQ(energies.kinetic, 0);
  EXPECT_EQ(energies.gravity, 0);
}

/// What is left of the objective after one step from the same stretched start.
template <typename Solver, typename Options>
double objective_after(const Model& model, Options options) {
  options.contact.mode = DetectionMode::kOff;
  options.time_step = 1.0 / 60;
  State state = make_state(model, model.rest_positions);
  for (Vec3& p : state.positions) p[0] *= 1.5;
  Solver solver(model, state, {}, {}, options);
  EXPECT_EQ(solver.objective(), 0);
  solver.step(state);
  return solver.objective();
}

TEST(Energies, OfAStepFallToThatOfNewtonsMethodWithMoreSweeps) {
  const Model model = make(make_box({0.3, 0.1, 0.1}, 0.05), neo_hookean(1e4, 0.4));
  NewtonOptions exact;
  exact.newton_steps = 50;
  exact.tolerance = exact.linear_tolerance = 1e-9;
  const double least = objective_after<NewtonSolver>(model, exact);
  double before = std::numeric_limits<double>::infinity();
  for (const int sweeps : {2, 10, 300}) {
    VbdOptions options;
    options.iterations = sweeps;
    const double after = objective_after<VbdSolver>(model, options);
    EXPECT_LT(after, before) << sweeps;
    EXPECT_GT(after, least * (1 - 1e-12)) << sweeps;
    before = after;
  }
  EXPECT_NEAR(before, least, 1e-6 * least);
}

}  // namespace
}  // namespace selvage
