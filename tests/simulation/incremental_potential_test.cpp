// The function that the implicit solvers minimise, its derivatives, and Newton's method on it.
#include "simulation/bodies.h"
#include "simulation/newton/minimize.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// Vertices as TimeStep gives them, without inverse mass where they are held.
std::vector<StepVertex> step_vertices(const Model& model, std::span<const Vec3> targets, std::span<const Index> held) {
  std::vector<StepVertex> vertices;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    vertices.push_back({{targets[v][0], targets[v][1], targets[v][2]}, model.inverse_masses[v]});
  for (const Index v : held) vertices[v].inverse_mass = 0;
  return vertices;
}

/// Contacts of a vertex with a face, and one of a vertex with a collider.
std::vector<OffsetTerm> some_contacts(const IncrementalPotential& potential) {
  OffsetTerm pair;
  pair.count = 4;
  pair.vertices = {0, 5, 9, 13};
  pair.weights = {1, -0.2, -0.5, -0.3};
  pair.normal = Vec3(1, 2, 2) / 3;
  pair.target = 0.5;
  pair.stiffness = 20 * potential.stiffness(0);
  pair.coefficient = 0.5;
  pair.slip = 0.01;
  OffsetTerm wall = pair;
  wall.count = 1;
  wall.vertices[0] = 7;
  wall.weights[0] = 1;
  wall.origin = Vec3(0, 0, 0.3);
  // Of a thickness, partly and all beyond where its stiffness grows.
  OffsetTerm near = pair, nearer = pair;
  near.vertices[0] = 6;
  near.ramp = 10;
  nearer.vertices[0] = 4;
  nearer.ramp = 0.01;
  return {pair, wall, near, nearer};
}

TEST(IncrementalPotential, HasDerivativesThatAreFiniteDifferences) {
  for (const Material& material : {damped(neo_hookean(1e4), 0.01), damped(springs(1e-3, 1e-7), 0.01)}) {
    const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), material);
    IncrementalPotential potential(model, 0.01);
    const std::vector<Vec3> start = jittered(model.rest_positions, 0.01, 1), velocities(start.size(), Vec3::Zero());
    const Step step{1, 0, 0.01, start, velocities};
    const std::vector<Index> held{3, 4};
    potential.begin(step, step_vertices(model, jittered(start, 0.02, 2), held));
    potential.set_contacts(some_contacts(potential));
    std::vector<Vec3> x = jittered(start, 0.02, 3);
    potential.renew_friction(x, false);
    Eigen::VectorXd gradient, above, below, alone;
    BlockMatrix matrix;
    EXPECT_TRUE(potential.assemble(x, false, gradient, matrix));
    potential.find_gradient(x, alone);
    EXPECT_LT((gradient - alone).norm(), 1e-12 * gradient.norm());
    EXPECT_GT(gradient.segment<3>(21).norm(), 0);
    const double size = gradient.norm(), shift = 1e-7;
    for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
      const VertexDerivatives own = potential.is_free(v) ? potential.by_vertex(x, v) : VertexDerivatives{};
      if (potential.is_free(v)) {
        EXPECT_LT((own.gradient - gradient.segment<3>(3 * v)).norm(), 1e-11 * size);
      } else {
        EXPECT_EQ(gradient.segment<3>(3 * v).norm(), 0);
        continue;
      }
      for (int axis = 0; axis < 3; ++axis) {
        const double at = x[v][axis];
        x[v][axis] = at + shift;
        const double energy_above = potential.energy(x);
        x[v][axis] = at - shift;
        const double energy_below = potential.energy(x);
        x[v][axis] = at;
        ASSERT_NEAR(gradient[3 * v + axis], (energy_above - energy_below) / (2 * shift), 1e-5 * size) << v;
      }
    }
  }
}

TEST(IncrementalPotential, HasAHessianThatIsADifferenceOfGradients) {
  const Model model = make(make_box({0.2, 0.2, 0.2}, 0.1), damped(neo_hookean(1e4), 0.02));
  IncrementalPotential potential(model, 0.01);
  std::vector<Vec3> x = jittered(model.rest_positions, 0.01, 4);
  const std::vector<Vec3> velocities(x.size(), Vec3::Zero());
  potential.begin({1, 0, 0.01, model.rest_positions, velocities}, step_vertices(model, x, std::vector<Index>{2}));
  potential.set_contacts(some_contacts(potential));
  Eigen::VectorXd gradient, above, below, column, unit = Eigen::VectorXd::Zero(3 * std::ssize(x));
  BlockMatrix matrix;
  potential.assemble(x, true, gradient, matrix);
  for (Eigen::Index i = 0; i < unit.size(); ++i) {
    unit[i] = 1;
    matrix.multiply(unit, column);
    unit[i] = 0;
    if (!potential.is_free(static_cast<Index>(i / 3))) continue;
    double& at = x[i / 3][i % 3];
    const double middle = at;
    at = middle + 1e-6;
    potential.find_gradient(x, above);
    at = middle - 1e-6;
    potential.find_gradient(x, below);
    at = middle;
    EXPECT_LT((column - (above - below) / 2e-6).norm(), 1e-5 * column.norm()) << i;
  }
}

TEST(OffsetTerm, OfAThicknessIsTwiceContinuouslyDifferentiable) {
  OffsetTerm term;
  term.normal = Vec3(2, -1, 2) / 3;
  term.target = 0.3;
  term.stiffness = 7;
  term.ramp = 0.1;
  const auto at = [&](double depth) -> Vec3 { return (term.target - depth) * term.normal; };
  const auto stiffness = [&](double depth) {
    return double(term.normal.transpose() * term.derivatives(at(depth)).hessian * term.normal);
  };
  constexpr double kShift = 1e-5;
  for (int i = -100; i <= 300; ++i) {
    const double depth = 1e-3 * i, before = depth - kShift, after = depth + kShift;
    const double slope = (term.energy(at(after)) - term.energy(at(before))) / (2 * kShift);
    ASSERT_NEAR(-term.normal.dot(term.gradient(at(depth))), slope, 1e-7) << depth;
    const double bend = term.normal.dot(term.gradient(at(before)) - term.gradient(at(after))) / (2 * kShift);
    ASSERT_NEAR(stiffness(depth), bend, term.stiffness / term.ramp * kShift) << depth;
    // Nowhere a jump: that of a square is all of the stiffness.
    ASSERT_NEAR(stiffness(before), stiffness(after), 3 * term.stiffness / term.ramp * kShift) << depth;
  }
  EXPECT_EQ(term.energy(at(-1e-9)), 0);
  EXPECT_DOUBLE_EQ(stiffness(0.2), term.stiffness);
  term.ramp = 0;
  EXPECT_GT(stiffness(kShift) - stiffness(-kShift), 0.99 * term.stiffness);
}

TEST(Minimize, ConvergesQuadraticallyNearTheSolution) {
  const Model model = make(make_box({0.4, 0.2, 0.2}, 0.1), neo_hookean(1e4, 0.4));
  IncrementalPotential potential(model, 0.05);
  const std::vector<Vec3> velocities(model.rest_positions.size(), Vec3::Zero());
  std::vector<Vec3> targets = model.rest_positions;
  for (Vec3& p : targets) p += Vec3(0.1 * p[1], 0, -0.3 * p[0]);
  potential.begin({1, 0, 0.05, model.rest_positions, velocities},
                  step_vertices(model, targets, hold(model, [](const Vec3& p) { return p[0] < 0.01; }).vertices));
  LinearSystem system(LinearSolver::kDirect, 1e-4);
  BlockMatrix matrix;
  std::vector<double> residuals;
  for (int steps = 1; steps < 12 && (residuals.empty() || residuals.back() > 1e-14); ++steps) {
    std::vector<Vec3> x = targets;
    minimize(potential, system, {.steps = steps, .least_move = 0, .near_move = 0.01}, matrix, x);
    residuals.push_back(residual_of(potential, x));
  }
  EXPECT_LT(residuals.back(), 1e-13);
  EXPECT_LT(residuals.size(), 10U);
  // The last steps before rounding each square the residual, up to a constant factor.
  int quadratic = 0;
  for (std::size_t i = 1; i < residuals.size(); ++i)
    if (residuals[i - 1] < 1e-3) quadratic += residuals[i] < 100 * residuals[i - 1] * residuals[i - 1] + 1e-14;
  EXPECT_GE(quadratic, 2) << testing::PrintToString(residuals);
}

TEST(LinearSystem, SolvesByFactorizationAndByConjugateGradientsAlike) {
  const Model model = make(make_box({0.3, 0.2, 0.2}, 0.05), damped(neo_hookean(1e5), 0.002));
  IncrementalPotential potential(model, 0.01);
  const std::vector<Vec3> velocities(model.rest_positions.size(), Vec3::Zero());
  const std::vector<Vec3> x = jittered(model.rest_positions, 0.01, 5);
  potential.begin({1, 0, 0.01, model.rest_positions, velocities}, step_vertices(model, x, std::vector<Index>{1, 2}));
  potential.set_contacts(some_contacts(potential));
  Eigen::VectorXd gradient, exact, near, back;
  BlockMatrix matrix;
  potential.assemble(x, false, gradient, matrix);
  gradient.setRandom();
  EXPECT_EQ(LinearSystem(LinearSolver::kDirect, 1e-4).solve(matrix, true, gradient, exact).value_or(-1), 0);
  matrix.multiply(exact, back);
  EXPECT_LT((back - gradient).norm(), 1e-9 * gradient.norm());
  EXPECT_GT(LinearSystem(LinearSolver::kConjugateGradients, 1e-10).solve(matrix, true, gradient, near).value_or(0), 5);
  EXPECT_LT((near - exact).norm(), 1e-7 * exact.norm());
}

}  // namespace
}  // namespace selvage
