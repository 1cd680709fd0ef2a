#include "simulation/bodies.h"

#include <gtest/gtest.h>

#include <random>

namespace selvage {
namespace {

using namespace bodies;

State equilibrium_of(const Model& model, const Handle& handle) {
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.time_step = 1.0 / 1500;
  options.iterations = 10;
  options.velocity_damping = 10;
  const int steps = 3000;
  XpbdSolver solver(model, state, {handle}, {}, options);
  for (int i = 0; i < steps; ++i) solver.step(state);
  return state;
}

// A bar that hangs from its upper end gets longer by rho g L^2 / (2 E).
TEST(Equilibrium, OfAHangingBarHasTheLengthOfTheFormula) {
  for (const double youngs_modulus : {2e5, 5e5}) {
    const Model model = make(make_box({0.1, 0.1, 0.5}, 0.05), neo_hookean(youngs_modulus, 0.3));
    const State state = equilibrium_of(model, hold(model, [](const Vec3& p) { return p[2] > 0.499; }));
    double lowest = 0;
    for (const Vec3& p : state.positions) lowest = std::min(lowest, p[2]);
    const double expected = 1000 * 9.81 * 0.25 / (2 * youngs_modulus);
    EXPECT_NEAR(-lowest, expected, 0.03 * expected) << youngs_modulus;
  }
}

/// Elastic energy of an element, written anew from the formula in Macklin and Mueller [J].
double energy_of(const Model& model, const std::vector<Vec3>& positions, Index element) {
  const auto& e = model.mesh.elements()[element];
  const Material& m = model.bodies[0].material;
  Eigen::Matrix3d rest, now;
  for (int k = 0; k < 3; ++k) {
    rest.col(k) = model.rest_positions[e[k + 1]] - model.rest_positions[e[0]];
    now.col(k) = positions[e[k + 1]] - positions[e[0]];
  }
  const Eigen::Matrix3d f = now * rest.inverse();
  const double shear = m.youngs_modulus / (2 * (1 + m.poisson_ratio));
  const double bulk = m.youngs_modulus * m.poisson_ratio / ((1 + m.poisson_ratio) * (1 - 2 * m.poisson_ratio)) + shear;
  const double dilation = f.determinant() - 1 - shear / bulk;
  return rest.determinant() / 6 * (shear / 2 * (f.squaredNorm() - 3) + bulk / 2 * dilation * dilation);
}

// Where a beam held at one end sags to, the forces of Macklin and Mueller's energy carry the weight of every vertex.
TEST(Equilibrium, OfASaggingBeamBalancesForces) {
  const Model model = make(make_box({0.4, 0.1, 0.1}, 0.05), neo_hookean(1e5, 0.4));
  const State state = equilibrium_of(model, hold(model, [](const Vec3& p) { return p[0] < 0.001; }));
  double lowest = 0, worst = 0, weight = 0;
  std::vector<Vec3> positions = state.positions;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    lowest = std::min(lowest, positions[v][2]);
    if (model.rest_positions[v][0] < 0.001) continue;
    Vec3 force = mass(model, v) * Vec3(0, 0, -9.81);
    weight += force.norm();
    for (int axis = 0; axis < 3; ++axis) {
      const double at = positions[v][axis], step = 1e-6;
      for (const Index e : model.mesh.vertex_elements(v)) {
        positions[v][axis] = at + step;
        const double above = energy_of(model, positions, e);
        positions[v][axis] = at - step;
        force[axis] -= (above - energy_of(model, positions, e)) / (2 * step);
      }
      positions[v][axis] = at;
    }
    worst = std::max(worst, force.norm());
  }
  EXPECT_LT(lowest, -0.03);  // it has sagged
  EXPECT_LT(worst, 0.02 * weight) << lowest;
}

/// Where a body starts: a map of its rest pose.
struct Tangle {
  const char* name;
  Vec3 (*map)(const Vec3&, std::mt19937&);
};

TEST(Recovery, FromInvertedAndFlattenedElements) {
  const Tangle tangles[] = {
      {"mirrored", [](const Vec3& p, std::mt19937&) { return Vec3(p[0], p[1], -p[2]); }},
      {"flat", [](const Vec3& p, std::mt19937&) { return Vec3(p[0], p[1], 0); }},
      {"nearly flat", [](const Vec3& p, std::mt19937&) { return Vec3(p[0], p[1], 1e-3 * p[2]); }},
      {"random",
       [](const Vec3&, std::mt19937& engine) {
         const auto next = [&] { return 0.4e-9 * static_cast<double>(engine() % 1'000'000'000); };
         const double x = next(), y = next(), z = next();
         return Vec3(x, y, z);
       }},
  };
  for (const Tangle& tangle : tangles)
    for (const double youngs_modulus : {1e5, 1e6, 1e8}) {
      const Model model = make(make_box({0.4, 0.2, 0.2}, 0.05), neo_hookean(youngs_modulus));
      std::mt19937 engine(1);
      State state = make_state(model, model.rest_positions);
      for (Vec3& p : state.positions) p = tangle.map(p, engine);
      EXPECT_GT(inverted_elements(model, state) + (tangle.name == std::string("nearly flat")), 0);
      XpbdOptions options = without_contact();
      options.gravity.setZero();
      options.velocity_damping = 3;
      XpbdSolver solver(model, state, {}, {}, options);
      for (int i = 0; i < 400; ++i) solver.step(state);
      EXPECT_EQ(inverted_elements(model, state), 0) << tangle.name << ", " << youngs_modulus;
      // A mirrored body may lock on its way.
      if (tangle.name == std::string("mirrored")) continue;
      EXPECT_LT(worst_stretch(model, state), 0.01) << tangle.name << ", " << youngs_modulus;
    }
}

/// The apex of an element on three pinned corners, pressed through these by more than its energy bears, which then
/// holds it there.
std::int64_t steps_inside_out(DetectionMode mode) {
  IndexedMesh tet;
  tet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tet.tetrahedra = {{0, 1, 2, 3}};
  Model model = make(tet, neo_hookean(1e3));
  for (int v = 0; v < 3; ++v) model.inverse_masses[v] = 0;
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = without_contact();
  options.contact.mode = mode;
  options.gravity = Vec3(0, 0, -40);
  options.velocity_damping = 10;
  XpbdSolver solver(model, state, {}, {}, options);
  std::int64_t count = 0;
  for (int i = 0; i < 1000; ++i) {
    solver.step(state);
    count += inverted_elements(model, state);
  }
  return count;
}

TEST(Recovery, OfWhatTheEnergyWouldLeaveInsideOut) {
  for (const DetectionMode mode : {DetectionMode::kOff, DetectionMode::kCcd, DetectionMode::kDcd})
    EXPECT_LT(steps_inside_out(mode), 100);
}

TEST(Recovery, OfASingleElement) {
  IndexedMesh tet;
  tet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tet.tetrahedra = {{0, 1, 2, 3}};
  for (const double height : {-3.0, -1.0, -0.01, 0.0, 1e-6, 0.01, 5.0})
    for (const double youngs_modulus : {1e5, 1e7, 1e9}) {
      const Model model = make(tet, neo_hookean(youngs_modulus));
      State state = make_state(model, model.rest_positions);
      state.positions[3][2] = height;
      XpbdOptions options = without_contact();
      options.gravity.setZero();
      options.velocity_damping = 10;
      XpbdSolver solver(model, state, {}, {}, options);
      for (int i = 0; i < 600; ++i) solver.step(state);
      EXPECT_LT(worst_stretch(model, state), 0.01) << height << ", " << youngs_modulus;
      EXPECT_EQ(inverted_elements(model, state), 0) << height << ", " << youngs_modulus;
    }
}

}  // namespace
}  // namespace selvage
