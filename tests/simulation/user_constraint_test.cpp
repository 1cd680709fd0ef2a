// The user's side of a solver: a constraint between iterations, and the contacts of a step.
#include "selvage/core/error.h"
#include "simulation/bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <type_traits>

namespace selvage {
namespace {

using namespace bodies;

template <typename GivenModel>
constexpr bool kTakesModel = std::is_constructible_v<XpbdSolver, GivenModel, const State&, std::vector<Handle>,
                                                     std::vector<Collider>, const XpbdOptions&>;
static_assert(kTakesModel<const Model&> && kTakesModel<Model&>);
static_assert(!kTakesModel<Model> && !kTakesModel<const Model>, "a temporary would not outlive the solver");

/// Holds two vertices at a distance.
UserConstraint hold_distance(Index a, Index b, double length) {
  return [=](const StepVertices& vertices, int) {
    const Vec3 offset = vertices.position(a) - vertices.position(b);
    const double mobility = vertices.inverse_mass(a) + vertices.inverse_mass(b);
    const Vec3 correction = (length - offset.norm()) / mobility * offset.normalized();
    vertices.position(a) += vertices.inverse_mass(a) * correction;
    vertices.position(b) -= vertices.inverse_mass(b) * correction;
  };
}

/// Two boxes one after the other along x, and the vertices that face each other in their middles.
struct TwoBoxes {
  Model model;
  State state;
  Index left = kNone, right = kNone;

  explicit TwoBoxes(double gap) {
    const IndexedMesh box = make_box({0.2, 0.2, 0.2}, 0.1);
    const Vec3 offset{0.2 + gap, 0, 0};
    model = make(std::array{box, moved(box, offset)}, neo_hookean(1e5));
    state = make_state(model, model.rest_positions);
    left = at({0.2, 0.1, 0.1});
    right = at(offset + Vec3(0, 0.1, 0.1));
  }

  Index at(const Vec3& place) const {
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      if ((model.rest_positions[v] - place).norm() < 1e-9) return v;
    throw std::logic_error("no vertex there");
  }
  double distance() const { return (state.positions[left] - state.positions[right]).norm(); }
};

TEST(UserConstraint, HoldsTwoBodiesAtADistanceAndKeepsMomentumWithoutGainOfEnergy) {
  TwoBoxes boxes(0.3);
  for (int b = 0; b < 2; ++b)
    for (Index v = 0; v < boxes.model.bodies[b].vertex_count; ++v)
      boxes.state.velocities[boxes.model.bodies[b].first_vertex + v] = Vec3(0.5, b == 0 ? 1 : -1, 0);
  XpbdOptions options = without_contact();
  options.gravity.setZero();
  XpbdSolver solver(boxes.model, boxes.state, {}, {}, options);
  solver.set_constraint(hold_distance(boxes.left, boxes.right, 0.3));
  const Vec3 momentum_before = momentum(boxes.model, boxes.state);
  const double energy_before = kinetic_energy(boxes.model, boxes.state);
  for (int i = 0; i < 600; ++i) {
    solver.step(boxes.state);
    ASSERT_NEAR(boxes.distance(), 0.3, 1e-12) << "step " << i;
    ASSERT_LE(kinetic_energy(boxes.model, boxes.state), energy_before * (1 + 1e-9)) << "step " << i;
  }
  EXPECT_LT((momentum(boxes.model, boxes.state) - momentum_before).norm(), 1e-9 * momentum_before.norm());
  // Without the constraint they would be 4 m apart.
  EXPECT_LT((centre(boxes.model, boxes.state) - boxes.state.positions[boxes.left]).norm(), 0.5);
  // A regression mark: as much energy is left after 600 steps as a circling pair has, less what the springs take up.
  EXPECT_GT(kinetic_energy(boxes.model, boxes.state), 0.4 * energy_before);
}

/// Of two boxes that fall on a plane and meet.
State run_boxes(const std::function<void(XpbdSolver&)>& prepare) {
  TwoBoxes boxes(0.01);
  boxes.model.bodies[1].initial_velocity = Vec3(-1, 0, 0);
  boxes.state = make_state(boxes.model, boxes.model.rest_positions);
  XpbdOptions options;
  options.iterations = 6;
  XpbdSolver solver(boxes.model, boxes.state, {}, {{PlaneShape{Vec3(0, 0, -0.01)}}}, options);
  prepare(solver);
  for (int i = 0; i < 60; ++i) solver.step(boxes.state);
  return boxes.state;
}

TEST(UserConstraint, ThatMovesNothingChangesNoBit) {
  const State without = run_boxes([](XpbdSolver&) {});
  const State taken_away = run_boxes([](XpbdSolver& solver) {
    solver.set_constraint(hold_distance(0, 1, 1));
    solver.set_constraint({});
  });
  const State idle = run_boxes([](XpbdSolver& solver) { solver.set_constraint([](const StepVertices&, int) {}); });
  for (const State* state : {&taken_away, &idle}) {
    EXPECT_EQ(state->positions, without.positions);
    EXPECT_EQ(state->velocities, without.velocities);
  }
}

TEST(UserConstraint, IsCalledOnceAnIterationWithVerticesThatHandlesHoldMarked) {
  TwoBoxes boxes(0.3);
  XpbdOptions options = without_contact();
  options.iterations = 5;
  XpbdSolver solver(boxes.model, boxes.state, {{{boxes.left}}}, {}, options);
  std::vector<int> iterations;
  solver.set_constraint([&](const StepVertices& vertices, int iteration) {
    iterations.push_back(iteration);
    ASSERT_EQ(vertices.size(), boxes.model.mesh.vertex_count());
    EXPECT_EQ(vertices.inverse_mass(boxes.left), 0);
    EXPECT_EQ(vertices.inverse_mass(boxes.right), boxes.model.inverse_masses[boxes.right]);
  });
  solver.step(boxes.state);
  EXPECT_EQ(iterations, (std::vector{0, 1, 2, 3, 4}));
}

TEST(UserConstraint, ThatThrowsOrLeavesNothingFiniteKeepsTheStateBefore) {
  TwoBoxes boxes(0.3);
  XpbdSolver solver(boxes.model, boxes.state, {}, {}, without_contact());
  const State before = boxes.state;
  solver.set_constraint([](const StepVertices&, int) { throw std::runtime_error("stop"); });
  EXPECT_THROW(solver.step(boxes.state), std::runtime_error);
  solver.set_constraint([](const StepVertices& vertices, int) { vertices.position(3) *= NAN; });
  EXPECT_THROW(solver.step(boxes.state), Error);
  EXPECT_EQ(boxes.state.positions, before.positions);
  EXPECT_EQ(boxes.state.steps, 0);
}

TEST(StepContacts, AreThoseThatTheStatisticsCountAndNameBoundaryFacesAndVertices) {
  TwoBoxes boxes(0.01);
  for (Index v = boxes.model.bodies[1].first_vertex; v < boxes.model.mesh.vertex_count(); ++v)
    boxes.state.velocities[v] = Vec3(-1, 0, 0);
  XpbdOptions options;
  options.gravity.setZero();
  XpbdSolver solver(boxes.model, boxes.state, {}, {}, options);
  EXPECT_TRUE(solver.contacts().empty());
  solver.step(boxes.state);
  EXPECT_TRUE(solver.contacts().empty()) << "1/300 s is too short for the gap";
  std::size_t most = 0;
  for (int i = 0; i < 30; ++i) {
    solver.step(boxes.state);
    most = std::max(most, solver.contacts().size());
    std::array<std::int64_t, kContactKinds> counts{};
    for (const Contact& contact : solver.contacts()) {
      ++counts[static_cast<int>(contact.kind)];
      double sum = 0;
      for (int k = 0; k < contact.count; ++k) {
        ASSERT_LT(contact.vertices[k], boxes.model.mesh.vertex_count());
        sum += contact.weights[k];
      }
      EXPECT_NEAR(sum, 0, 1e-12);
      if (contact.kind != ContactKind::kVertexFace) continue;
      ASSERT_LT(contact.surface_feature, boxes.model.mesh.boundary_face_count());
      const auto& face = boxes.model.mesh.boundary_faces()[contact.surface_feature];
      for (int k = 1; k < contact.count; ++k)
        EXPECT_NE(std::find(face.begin(), face.end(), contact.vertices[k]), face.end());
    }
    EXPECT_EQ(counts, solver.statistics().contact.contacts);
  }
  EXPECT_GT(most, 4u);
}

}  // namespace
}  // namespace selvage
