#include "simulation/time_step/deformation_damping.h"

#include "simulation/bodies.h"
#include "simulation/rigid_motion.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <random>

namespace selvage {
namespace {

using namespace bodies;

/// Two boxes, one far from the origin, in any motion.
struct Boxes {
  Model model = make(std::vector<IndexedMesh>{make_box({0.4, 0.2, 0.2}, 0.05),
                                              moved(make_box({0.2, 0.2, 0.2}, 0.1), Vec3(300, -200, 50))},
                     neo_hookean(1e5));
  State state = make_state(model, model.rest_positions);

  explicit Boxes(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> number(-1, 1);
    for (Vec3& velocity : state.velocities) velocity = Vec3(number(random), number(random), number(random));
  }
};

void damp(Boxes& boxes, double kept) {
  const Pieces pieces(boxes.model);
  State& state = boxes.state;
  const auto momentum = pieces.momentum(state.positions, [&](Index v) { return state.velocities[v]; });
  damp_deformation(pieces, momentum, kept, state.positions, state.velocities);
}

Vec3 spin_of(const Boxes& boxes, Index first, Index count) {
  MomentumSums sums(boxes.state.positions[first]);
  for (Index v = first; v < first + count; ++v)
    sums.add(mass(boxes.model, v), boxes.state.positions[v], boxes.state.velocities[v]);
  const RigidMotion motion = sums.motion();
  return {motion.linear(2, 1), motion.linear(0, 2), motion.linear(1, 0)};
}

TEST(RigidMotion, IsThatOfPointsThatMoveRigidly) {
  const Vec3 turn(0.3, -2, 1), shift(4, 5, -6), centre(100, 20, -3);
  MomentumSums sums(centre), flat(centre);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) {
    points.emplace_back(centre + Vec3(number(random), number(random), number(random)));
    sums.add(1 + number(random) / 2, points.back(), shift + turn.cross(Vec3(points.back() - centre)));
    flat.add(1, centre + Vec3(i, 0, 0), shift);
  }
  for (const Vec3& p : points) EXPECT_LT((sums.motion()(p) - shift - turn.cross(Vec3(p - centre))).norm(), 1e-12);
  EXPECT_TRUE(flat.motion().linear.isZero(0));  // on a line
  EXPECT_LT((flat.motion().shift - shift).norm(), 1e-14);
  EXPECT_TRUE(MomentumSums().motion().shift.isZero(0));
}

TEST(DeformationDamping, KeepsMomentumAndSpinOfEachPieceAndTakesTheRest) {
  Boxes boxes(1);
  const auto& bodies = boxes.model.bodies;
  const Boxes before = boxes;
  damp(boxes, 0.25);
  for (const Body& body : bodies) {
    const Vec3 spin = spin_of(before, body.first_vertex, body.vertex_count);
    EXPECT_LT((spin_of(boxes, body.first_vertex, body.vertex_count) - spin).norm(), 1e-10);
    Vec3 change = Vec3::Zero();
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      change += mass(boxes.model, v) * (boxes.state.velocities[v] - before.state.velocities[v]);
    EXPECT_LT(change.norm(), 1e-12);
  }
  // Applied again with nothing kept, each piece is rigid: then nothing changes any more.
  damp(boxes, 0);
  const std::vector<Vec3> rigid = boxes.state.velocities;
  damp(boxes, 0.5);
  for (std::size_t v = 0; v < rigid.size(); ++v) ASSERT_LT((boxes.state.velocities[v] - rigid[v]).norm(), 1e-10);
  EXPECT_LT(kinetic_energy(boxes.model, boxes.state), kinetic_energy(before.model, before.state));
}

TEST(DeformationDamping, GivesTheSameForAnyNumberOfThreads) {
  test::same_for_any_threads([] {
    Boxes boxes(2);
    damp(boxes, 0.5);
    return boxes.state.velocities;
  });
}

TEST(DeformationDamping, LetsABodyFallAndTurnAsWithout) {
  const Model model = make(make_box({0.4, 0.2, 0.2}, 0.1), neo_hookean(1e6));
  State state = make_state(model, model.rest_positions);
  for (std::size_t v = 0; v < state.velocities.size(); ++v)
    state.velocities[v] = Vec3(1, 2, 3) + Vec3(0, 0, 0.2).cross(state.positions[v]);
  XpbdOptions options = without_contact();
  options.deformation_damping = 20;
  XpbdSolver solver(model, state, {}, {}, options);
  const Vec3 before = momentum(model, state);
  double total = 0;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) total += mass(model, v);
  for (int i = 0; i < 30; ++i) solver.step(state);
  EXPECT_LT((momentum(model, state) - before - 0.1 * total * options.gravity).norm(), 1e-9 * before.norm());
}

TEST(DeformationDamping, ChangesNoBitOfAFlightHoweverFast) {
  Boxes boxes(3);
  for (Vec3& velocity : boxes.state.velocities) velocity = Vec3(1e38, 3, -1e-7);
  const Boxes before = boxes;
  damp(boxes, 0.5);
  EXPECT_TRUE(same_bits(boxes.state, before.state));
}

}  // namespace
}  // namespace selvage
