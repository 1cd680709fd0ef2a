#include "simulation/bodies.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

const IndexedMesh kBeam = make_box({1, 0.5, 0.5}, 0.1);

TEST(FreeBody, FallsWithoutDeforming) {
  for (const Material& material : {neo_hookean(1e5), neo_hookean(1e8), springs()}) {
    const Model model = make(kBeam, material);
    State state = make_state(model, model.rest_positions);
    const XpbdOptions options = without_contact();
    XpbdSolver solver(model, state, {}, {}, options);
    const int steps = 300;
    for (int i = 0; i < steps; ++i) solver.step(state);
    EXPECT_EQ(state.steps, steps);
    EXPECT_DOUBLE_EQ(state.time, 1);
    // Symplectic Euler: the fall of n steps is g h^2 n (n + 1) / 2.
    const Vec3 fall = options.gravity * (options.time_step * options.time_step * steps * (steps + 1) / 2);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      ASSERT_LT((state.positions[v] - model.rest_positions[v] - fall).norm(), 1e-8) << v;
  }
}

/// Turning at one turn a second about an axis that is no principal one, and drifting.
State spin(const Model& model) {
  State state = make_state(model, model.rest_positions);
  const Vec3 middle = centre(model, state), axis = 2 * M_PI * Vec3(1, 2, 2) / 3;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    state.velocities[v] = Vec3(3, -1, 2) + axis.cross(state.positions[v] - middle);
  return state;
}

/// Largest changes, relative to the start, over half a second in steps of that size.
struct Drift {
  double momentum = 0, angular_momentum = 0, gained_energy = 0;
};
Drift drift_of(const Material& material, double time_step) {
  const Model model = make(kBeam, material);
  State state = spin(model);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  options.time_step = time_step;
  const Vec3 linear = momentum(model, state), angular = angular_momentum(model, state);
  const double energy = kinetic_energy(model, state);
  XpbdSolver solver(model, state, {}, {}, options);
  Drift drift;
  while (state.time < 0.5) {
    solver.step(state);
    drift.momentum = std::max(drift.momentum, (momentum(model, state) - linear).norm() / linear.norm());
    drift.angular_momentum =
        std::max(drift.angular_momentum, (angular_momentum(model, state) - angular).norm() / angular.norm());
    drift.gained_energy = std::max(drift.gained_energy, kinetic_energy(model, state) / energy - 1);
  }
  return drift;
}

TEST(FreeBody, KeepsItsMomentumInFlight) {
  for (const Material& material : {neo_hookean(1e5), neo_hookean(1e7), springs(1e-6)}) {
    const Drift coarse = drift_of(material, 1.0 / 300), fine = drift_of(material, 1.0 / 1200);
    EXPECT_LT(coarse.momentum, 1e-11);
    EXPECT_LT(fine.momentum, 1e-11);
    EXPECT_LT(coarse.angular_momentum, 1e-11);
    EXPECT_LT(fine.angular_momentum, 1e-11);
    // The material is implicit and loses energy; what is given back to the spin is no more than that.
    EXPECT_LT(coarse.gained_energy, 1e-5);
    EXPECT_LT(fine.gained_energy, 1e-6);
  }
}

TEST(FreeBody, ComesToRestAfterAStretch) {
  for (const Material& material : {neo_hookean(1e4), neo_hookean(1e6), springs(1e-5)}) {
    const Model model = make(kBeam, material);
    State state = make_state(model, model.rest_positions);
    for (Vec3& p : state.positions) p[0] *= 1.5;
    XpbdOptions options = without_contact();
    options.gravity.setZero();
    options.velocity_damping = 5;
    XpbdSolver solver(model, state, {}, {}, options);
    for (int i = 0; i < 900; ++i) solver.step(state);
    EXPECT_LT(worst_stretch(model, state), 1e-3);
    EXPECT_EQ(inverted_elements(model, state), 0);
  }
}

TEST(FreeBody, LosesEnergyOfStretchingByDampingAndNoneOfItsFlight) {
  const auto energy_after = [](double damping, bool stretched) {
    Material material = neo_hookean(1e5);
    material.damping = damping;
    const Model model = make(kBeam, material);
    State state = make_state(model, model.rest_positions);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      state.velocities[v] = Vec3(stretched ? 2 * state.positions[v][0] - 1 : 1, 0, 0);
    XpbdOptions options = without_contact();
    options.gravity.setZero();
    XpbdSolver solver(model, state, {}, {}, options);
    const double before = kinetic_energy(model, state);
    for (int i = 0; i < 30; ++i) solver.step(state);
    return kinetic_energy(model, state) / before;
  };
  EXPECT_LT(energy_after(0.05, true), 0.5 * energy_after(0, true));
  EXPECT_NEAR(energy_after(0.05, false), 1, 1e-9);
}

TEST(FreeBody, IsAcceleratedByExternalForcesInTheStepsThatHaveThemUpToTheLargestSpeed) {
  const Model model = make(kBeam, neo_hookean(1e5));
  std::vector<Vec3> forces;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) forces.push_back(mass(model, v) * Vec3(4, 0, 0));
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  options.max_speed = 2;
  XpbdSolver solver(model, state, {}, {}, options);
  for (int i = 0; i < 75; ++i) solver.step(state, forces);
  for (const Vec3& velocity : state.velocities) ASSERT_LT((velocity - Vec3(1, 0, 0)).norm(), 1e-9);
  for (int i = 0; i < 75; ++i) solver.step(state);
  for (const Vec3& velocity : state.velocities) ASSERT_LT((velocity - Vec3(1, 0, 0)).norm(), 1e-9);
  for (int i = 0; i < 150; ++i) solver.step(state, forces);
  for (const Vec3& velocity : state.velocities) ASSERT_LT((velocity - Vec3(2, 0, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace selvage
