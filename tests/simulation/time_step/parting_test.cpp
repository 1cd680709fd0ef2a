// Bodies that start in one another part, and do not fly off.
#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "simulation/bodies.h"
#include "simulation/colliders/colliders.h"
#include "simulation/colliders/prepared_collider.h"
#include "threads.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace bodies;

/// Two blocks, the second half in the first.
Model overlapping(const Vec3& offset = {0.25, 0.05, 0.05}) {
  const IndexedMesh block = moved(make_box({0.5, 0.5, 0.5}, 0.17), {0, 0, 0.02});
  return make(std::vector<IndexedMesh>{block, moved(block, offset)}, damped(neo_hookean(1e5, 0.4), 0.002));
}

Vec3 middle_of(const Body& body, std::span<const Vec3> values) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& value : values.subspan(body.first_vertex, body.vertex_count)) sum += value;
  return sum / body.vertex_count;
}

/// How fast the two move apart [m/s], and how far apart they are [m].
struct Separation {
  double speed, distance;
};
Separation separation(const Model& model, const State& state) {
  const auto between = [&](std::span<const Vec3> values) {
    return Vec3(middle_of(model.bodies[1], values) - middle_of(model.bodies[0], values));
  };
  return {between(state.velocities).norm(), between(state.positions).norm()};
}

template <typename Solver, typename Options>
void expect_to_lie_side_by_side(Options options) {
  const Model model = overlapping();
  State state = make_state(model, model.rest_positions);
  Solver solver(model, state, {}, {Collider{.shape = PlaneShape{}}}, options);
  double highest = 0;
  for (int step = 0; step < 150; ++step) {
    solver.step(state);
    highest = std::max(highest, centre(model, state)[2]);
    if (step == 20) {
      EXPECT_LT(separation(model, state).speed, 2);
    }
  }
  solver.step(state);
  EXPECT_EQ(solver.statistics().unguarded_vertices, 0);
  EXPECT_LT(separation(model, state).speed, 0.3);
  EXPECT_GT(separation(model, state).distance, 0.45);
  EXPECT_LT(separation(model, state).distance, 1);
  EXPECT_LT(highest, 0.6);
}

TEST(Parting, LeavesBodiesSideBySideByEachSolver) {
  expect_to_lie_side_by_side<XpbdSolver>(XpbdOptions{});
  expect_to_lie_side_by_side<VbdSolver>(VbdOptions{});
  expect_to_lie_side_by_side<NewtonSolver>(NewtonOptions{});
}

// The floor that a body is pushed into does not throw both: they leave it no faster than they fell on it.
TEST(Parting, TakesNoSpeedFromTheFloor) {
  const Model model = overlapping({0.03, 0.02, 0.1});
  State state = make_state(model, model.rest_positions);
  XpbdSolver solver(model, state, {}, {Collider{.shape = PlaneShape{}}}, {});
  double all = 0;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) all += mass(model, v);
  for (int step = 0; step < 60; ++step) {
    solver.step(state);
    EXPECT_LT(momentum(model, state)[2], 0.2 * all) << step;
  }
}

/// A block that starts in a collider on a floor, after 300 steps.
struct Freed {
  Model model = make(std::vector<IndexedMesh>{moved(make_box({0.5, 0.5, 0.5}, 0.1), {0, 0, 0.02})},
                     damped(neo_hookean(1e5, 0.4), 0.002));
  State state = make_state(model, model.rest_positions);
  double farthest = 0;                ///< way of its middle
  double fastest = 0;                 ///< of any vertex
  std::int64_t inside = 0, deep = 0;  ///< of its vertices: what crosses a surface, and what is in the collider

  Freed(decltype(Collider::shape) shape, const Vec3& start = Vec3::Zero()) {
    for (Vec3& p : state.positions) p += start;
    const Vec3 from = centre(model, state);
    const std::vector<Collider> colliders{Collider{.shape = PlaneShape{}}, Collider{.shape = std::move(shape)}};
    XpbdSolver solver(model, state, {}, colliders, {});
    for (int step = 0; step < 300; ++step) {
      solver.step(state);
      farthest = std::max(farthest, (centre(model, state) - from).norm());
      for (const Vec3& velocity : state.velocities) fastest = std::max(fastest, velocity.norm());
    }
    solver.step(state);
    inside = solver.statistics().unguarded_vertices;
    for (const PreparedCollider& collider : prepare_colliders(colliders))
      for (const Vec3& p : state.positions) {
        const auto hit = std::visit([&](const auto& own) { return find_hit(own, p); }, collider.shape);
        if (hit && hit->depth > 1e-3) ++deep;
      }
  }
};

TEST(Parting, LeavesABlockBesideTheColliderThatItStartsIn) {
  // It flew 6.6 m along the floor, and was caught between the box and the floor on which that stands.
  for (const auto& shape : std::vector<decltype(Collider::shape)>{
           PlaneShape{{0.25, 0, 0}, Vec3::UnitX()},
           MeshShape(colliders::solid_box({0.25, -0.2, 0}, {0.75, 0.8, 1})),
           SphereShape{{0.5, 0.25, 0.25}, 0.25},
           CylinderShape{{0.4, 0.25, 0.5}, Vec3::UnitZ(), 0.15, 1},
       }) {
    const Freed block(shape);
    if (!std::holds_alternative<CylinderShape>(shape)) {  // A flat face lies against it between its vertices.
      EXPECT_EQ(block.inside, 0);
    }
    EXPECT_EQ(block.deep, 0);
    EXPECT_GT(block.farthest, 0.15);
    EXPECT_LT(block.farthest, 0.6);
  }
  const Freed sunk(SphereShape{{9, 9, 9}, 1}, {0, 0, -0.27});
  EXPECT_EQ(sunk.inside, 0);
  EXPECT_GT(sunk.farthest, 0.2);
  EXPECT_LT(sunk.farthest, 0.4);
}

/// A ball in a well a fifth narrower than it is: it starts in two walls and the floor, and is pressed against the
/// others.
TEST(Parting, LeavesNoBallInTheWallsOfAWell) {
  const Model model = make(moved(make_ball(0.25, 0.065), {-0.1, 0.05, 0.2}), neo_hookean(5e6, 0.4));
  State state = make_state(model, model.rest_positions);
  XpbdSolver solver(model, state, {}, {Collider{.shape = BoxContainer{{-0.2, -0.2, 0}, {0.2, 0.2, 3}}}}, {});
  std::int64_t inverted = 0;
  for (int step = 0; step < 150; ++step) {
    solver.step(state);
    inverted += inverted_elements(model, state);
  }
  EXPECT_EQ(inverted, 0);
  for (const Vec3& p : state.positions) {
    EXPECT_LT(p.head<2>().cwiseAbs().maxCoeff(), 0.202);
    EXPECT_GT(p[2], -0.002);
  }
}

/// Its vertices are nearest to all sides of what they start in, or to both of what lies between them: it was torn, or
/// hooked around that, and stayed.
TEST(Parting, LeavesNoBlockAcrossASolid) {
  for (const auto& shape : std::vector<decltype(Collider::shape)>{
           SphereShape{{0.27, 0.24, 0.4}, 0.2},
           CylinderShape{{0.2, 0.27, 0.4}, Vec3::UnitZ(), 0.1, 0.8},
           MeshShape(colliders::solid_box({0.1, -1, 0}, {0.43, 1.5, 0.7})),
           MeshShape(colliders::solid_box({-0.3, -0.3, 0.25}, {0.7, 0.8, 0.42})),
           MeshShape(colliders::solid_box({0.24, -0.6, 0}, {0.26, 1, 0.4})),
       }) {
    const Freed block(shape);
    if (std::holds_alternative<MeshShape>(shape)) {  // A flat face lies against a round side between its vertices.
      EXPECT_EQ(block.inside, 0);
    }
    EXPECT_EQ(block.deep, 0);
    EXPECT_GT(block.farthest, 0.2);
    EXPECT_LT(block.farthest, 1);
    EXPECT_LT(block.fastest, 6);
  }
}

/// Most of the block is in the wall, and vertices beyond its middle are nearest to its other side.
TEST(Parting, LeavesNoBlockHookedAroundAWall) {
  for (const double side : {0.1, 0.14}) {
    const Freed block(MeshShape(colliders::solid_box({side, -0.5, 0}, {side + 0.63, 1, 1})));
    EXPECT_EQ(block.inside, 0) << side;
    EXPECT_LT(block.farthest, 1) << side;
  }
}

TEST(Parting, KeepsMomentumAndSpinInFlight) {
  const Model model = overlapping();
  State state = make_state(model, model.rest_positions);
  for (std::size_t v = 0; v < state.velocities.size(); ++v)
    state.velocities[v] = Vec3(3, -1, 2) + Vec3(0.5, 1, -0.7).cross(state.positions[v]);
  XpbdOptions options;
  options.gravity.setZero();
  const Vec3 moving = momentum(model, state), turning = angular_momentum(model, state);
  XpbdSolver solver(model, state, {}, {}, options);
  for (int step = 0; step < 60; ++step) solver.step(state);
  EXPECT_LT((momentum(model, state) - moving).norm(), 1e-9 * moving.norm());
  EXPECT_LT((angular_momentum(model, state) - turning).norm(), 1e-9 * turning.norm());
  EXPECT_GT(separation(model, state).distance, 0.45);
}

// What only meets is not damped.
TEST(Parting, LeavesBodiesAloneThatAreOutside) {
  const IndexedMesh block = make_box({0.2, 0.2, 0.2}, 0.1);
  const Model model = make(std::vector<IndexedMesh>{block, moved(block, {0.25, 0.02, 0})}, neo_hookean(1e6, 0.4));
  State state = make_state(model, model.rest_positions);
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    state.velocities[v] = Vec3(v < model.bodies[1].first_vertex ? 4 : -4, 0, 0);
  XpbdSolver solver(model, state, {}, {}, {});
  for (int step = 0; step < 60; ++step) {
    solver.step(state);
    for (const double time : state.rest_times) EXPECT_GE(time, 0);
  }
  EXPECT_GT(separation(model, state).speed, 1);
}

TEST(Parting, IsTheSameByAnyNumberOfThreadsAndFromAnyState) {
  const Model model = overlapping();
  const auto run = [&](State state, int steps) {
    XpbdOptions options;
    options.sleep_speed = 0.015;
    XpbdSolver solver(model, state, {}, {Collider{.shape = PlaneShape{}}}, options);
    for (int step = 0; step < steps; ++step) solver.step(state);
    return state;
  };
  const State start = make_state(model, model.rest_positions);
  const State whole = test::with_threads(1, [&] { return run(start, 60); });
  EXPECT_TRUE(same_bits(test::with_threads(2, [&] { return run(start, 60); }), whole));
  const State half = run(start, 25);
  EXPECT_LT(half.rest_times[0], 0);
  EXPECT_TRUE(same_bits(run(half, 35), whole));
}

}  // namespace
}  // namespace selvage
