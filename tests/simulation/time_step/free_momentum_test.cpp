#include "simulation/time_step/free_momentum.h"

#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "simulation/bodies.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <random>

namespace selvage {
namespace {

using namespace bodies;

/// Two boxes that meet beside their middles; far from the origin.
struct MeetingBoxes {
  Model model = make(std::vector<IndexedMesh>{moved(make_box({0.4, 0.4, 0.4}, 0.1), {20, -30, 5}),
                                              moved(make_box({0.4, 0.4, 0.4}, 0.13), {20.42, -29.87, 5.07})},
                     neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);

  MeetingBoxes() {
    for (std::size_t v = 0; v < state.velocities.size(); ++v)
      state.velocities[v] = Vec3(is_first(v) ? 1 : -1, 0, 0) + Vec3(0.2, 1, -0.5).cross(from_middle(v));
  }
  bool is_first(std::size_t v) const { return static_cast<Index>(v) < model.bodies[0].vertex_count; }
  Vec3 from_middle(std::size_t v) const { return state.positions[v] - Vec3(20.4, -29.8, 5.2); }
  Vec3 spin() const {
    MomentumSums sums(state.positions[0]);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      sums.add(mass(model, v), state.positions[v], state.velocities[v]);
    return sums.spin();
  }
};

template <typename Solver, typename Options>
void expect_kept(Options options) {
  MeetingBoxes boxes;
  options.gravity = Vec3::Zero();
  const Vec3 turning = boxes.spin(), moving = momentum(boxes.model, boxes.state);
  Solver solver(boxes.model, boxes.state, {}, {}, options);
  std::size_t contacts = 0;
  for (int i = 0; i < 60; ++i) {
    solver.step(boxes.state);
    contacts += solver.contacts().size();
  }
  EXPECT_GT(contacts, 20u);
  EXPECT_LT((boxes.spin() - turning).norm(), 1e-9 * turning.norm());
  EXPECT_LT((momentum(boxes.model, boxes.state) - moving).norm(), 1e-9 * turning.norm());
}

TEST(FreeMomentum, IsKeptWhereBodiesMeetByEachSolverAndMode) {
  for (const DetectionMode mode : {DetectionMode::kHybrid, DetectionMode::kDcd, DetectionMode::kOff}) {
    XpbdOptions options;
    options.contact.mode = mode;
    if (mode != DetectionMode::kOff) expect_kept<XpbdSolver>(options);
  }
  expect_kept<VbdSolver>(VbdOptions{});
  expect_kept<NewtonSolver>(NewtonOptions{});
}

/// So fast that all of both is held back: relative to one another, not where they are.
TEST(FreeMomentum, LetsBodiesThatAreHeldBackFlyOn) {
  const IndexedMesh ball = make_ball(0.25, 0.07);
  for (const double speed : {15.0, 60.0}) {
    const Model model = make(std::vector<IndexedMesh>{ball, moved(ball, {0.7, 0.1, 0.05})}, neo_hookean(1e5, 0.4));
    State state = make_state(model, model.rest_positions);
    for (Index v = 0; v < model.mesh.vertex_count(); ++v)
      state.velocities[v] = Vec3(v < model.bodies[0].vertex_count ? speed : -speed, 40, 0);
    XpbdOptions options;
    options.gravity.setZero();
    XpbdSolver solver(model, state, {}, {}, options);
    const Vec3 start = centre(model, state);
    std::int64_t held = 0;
    for (int i = 0; i < 30; ++i) {
      solver.step(state);
      held += solver.statistics().held_back_vertices;
    }
    EXPECT_GT(held, 100);
    EXPECT_LT((centre(model, state) - start - Vec3(0, 4, 0)).norm(), 1e-6) << speed;
    EXPECT_EQ(inverted_elements(model, state), 0);
  }
}

/// Apart from one another each piece keeps its own; together they keep their sum.
TEST(FreeMomentum, GoesWithinGroupsOnly) {
  const MeetingBoxes boxes;
  FreeMomentum kept(boxes.model);
  const auto start = kept.pieces().momentum(boxes.state.positions, [&](Index v) { return boxes.state.velocities[v]; });
  const Index other = boxes.model.bodies[1].first_vertex;
  const auto changed = [&](std::span<const ZoneLink> links) {
    kept.begin();
    kept.join(links);
    MeetingBoxes later = boxes;
    for (std::size_t v = 0; v < later.state.velocities.size(); ++v)  // the first body turns faster, the second does not
      if (later.is_first(v)) later.state.velocities[v] += Vec3(1, 0, 0) + Vec3(0, 0, 3).cross(later.from_middle(v));
    const State solved = later.state;
    kept.restore(start, Vec3::Zero(), 1, later.state.positions, later.state.velocities);
    return std::pair(solved, later);
  };
  const auto [solved_apart, apart] = changed({});
  const auto [solved_joined, joined] = changed(std::array{ZoneLink{0, other}});
  for (Index v = other; v < boxes.model.mesh.vertex_count(); ++v) {
    ASSERT_LT((apart.state.velocities[v] - solved_apart.velocities[v]).norm(), 1e-12);
    ASSERT_GT((joined.state.velocities[v] - solved_joined.velocities[v]).norm(), 1e-3);
  }
  for (const MeetingBoxes& restored : {apart, joined}) {
    EXPECT_LT((restored.spin() - boxes.spin()).norm(), 1e-9);
    EXPECT_LT((momentum(boxes.model, restored.state) - momentum(boxes.model, boxes.state)).norm(), 1e-9);
  }

  // What a collider, which has no piece, acts on stays as the solver left it, with all that is in its group.
  for (const bool is_linked : {false, true}) {
    const std::array all{ZoneLink{0, kNone}, ZoneLink{0, is_linked ? other : 0}};
    const auto [solved, held] = changed(all);
    EXPECT_TRUE(!is_linked || same_bits(solved, held.state));
    for (Index v = 0; v < other; ++v) ASSERT_EQ(solved.velocities[v], held.state.velocities[v]);
  }
}

TEST(FreeMomentum, OfWhatIsPinnedOrPushedIsLeftToTheSolver) {
  MeetingBoxes boxes;
  boxes.model.inverse_masses[0] = 0;  // a corner of the first
  FreeMomentum kept(boxes.model);
  const auto start = kept.pieces().momentum(boxes.state.positions, [&](Index v) { return boxes.state.velocities[v]; });
  kept.begin();
  const Index other = boxes.model.bodies[1].first_vertex;
  kept.hold(boxes.model.mesh.vertex_count() - 1);
  State turned = boxes.state;
  for (Vec3& velocity : turned.velocities) velocity *= 2;
  const State solved = turned;
  kept.restore(start, Vec3::Zero(), 1, turned.positions, turned.velocities);
  EXPECT_TRUE(same_bits(solved, turned));

  kept.begin();  // in the next step only the pin is left
  kept.restore(start, Vec3::Zero(), 1, turned.positions, turned.velocities);
  for (Index v = 0; v < other; ++v) ASSERT_EQ(solved.velocities[v], turned.velocities[v]);
  EXPECT_NE(solved.velocities[other], turned.velocities[other]);
}

TEST(FreeMomentum, IsTheSameForAnyNumberOfThreads) {
  test::same_for_any_threads([] {
    MeetingBoxes boxes;
    XpbdSolver solver(boxes.model, boxes.state, {}, {}, XpbdOptions{});
    for (int i = 0; i < 30; ++i) solver.step(boxes.state);
    return std::pair(boxes.state.positions, boxes.state.velocities);
  });
}

TEST(MomentumSums, AddUpWhateverTheirOriginsAndFlights) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3(number(random), number(random), number(random)); };
  MomentumSums all(Vec3(1, 2, 3), Vec3(-1, 0, 2)), first(vector(), vector()), second(vector(), vector());
  for (int i = 0; i < 20; ++i) {
    const Vec3 x = vector(), v = vector();
    const double mass = 2 + number(random);
    all.add(mass, x, v);
    (i % 2 == 0 ? first : second).add(mass, x, v);
  }
  first.add(second);
  EXPECT_LT((first.spin() - all.spin()).norm(), 1e-12);
  for (int i = 0; i < 5; ++i) {
    const Vec3 x = vector();
    EXPECT_LT((first.motion()(x) - all.motion()(x)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace selvage
