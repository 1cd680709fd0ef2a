// Bodies that start in one another, however, come free.
#include "selvage/self_collision/self_collision.h"
#include "simulation/bodies.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace selvage {
namespace {

using namespace bodies;

constexpr int kStepsAFrame = 5;

IndexedMesh any_shape(std::mt19937& engine) {
  std::uniform_real_distribution<double> number(-1, 1);
  IndexedMesh mesh;
  switch (engine() % 4) {
    case 0:
      mesh = moved(make_box({0.5, 0.4, 0.4}, 0.13), {-0.25, -0.2, -0.2});
      break;
    case 1:
      mesh = make_shape("torus", {.elements = 500, .radius = 0.3, .inner_radius = 0.1});
      break;
    case 2:
      mesh = make_ball(0.28, 0.12);
      break;
    default:
      mesh = make_shape("rod", {.elements = 500, .length = 1, .radius = 0.08});
  }
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(number(engine), number(engine), number(engine), number(engine)).normalized();
  const Vec3 place(0.3 * number(engine), 0.3 * number(engine), 1.25 + 0.35 * number(engine));
  for (Vec3& p : mesh.positions) p = turn * p + place;
  return mesh;
}

TEST(OverlappingStarts, ComeFreeInAFewFrames) {
  std::int64_t overlapping = 0;
  const std::int64_t count = test::scaled(12, 2);
  for (std::int64_t n = 0; n < count; ++n) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(n));
    std::mt19937 engine(static_cast<unsigned>(seed));
    std::vector<IndexedMesh> meshes(3 + engine() % 4);
    for (IndexedMesh& mesh : meshes) mesh = any_shape(engine);
    const Model model = make(meshes, damped(neo_hookean(2e5, 0.4), 0.002));
    State state = make_state(model, model.rest_positions);
    XpbdSolver solver(model, state, {}, {Collider{.shape = PlaneShape{}}}, {});
    for (int step = 0; step < 20 * kStepsAFrame; ++step) {
      solver.step(state);
      if (step == 0) overlapping += solver.statistics().contact.penetrating_edges > 0;
    }
    solver.step(state);
    EXPECT_EQ(solver.statistics().unguarded_vertices, 0) << "seed " << seed;
  }
  EXPECT_GE(overlapping, count / 2);
}

/// A sheet whose end is turned over, in a curve narrower than two cells, and run down through it. It is flat at rest.
IndexedMesh folded_through_itself(const IndexedMesh& flat, double length, std::mt19937& engine) {
  std::uniform_real_distribution<double> number(0, 1);
  const double end = length * (0.25 + 0.2 * number(engine)), radius = 0.03 + 0.05 * number(engine);
  const double turn = std::numbers::pi * (1.15 + 0.1 * number(engine)), bend = length - end - radius * turn;
  IndexedMesh folded = flat;
  for (Vec3& p : folded.positions) {
    const double angle = std::clamp((p[0] - bend) / radius, 0.0, turn);
    const double ahead = p[0] < bend ? p[0] - bend : std::max(0.0, p[0] - bend - radius * turn);
    const double across = radius - p[2];
    p = Vec3(bend + std::sin(angle) * across + std::cos(angle) * ahead, p[1],
             radius - std::cos(angle) * across + std::sin(angle) * ahead);
  }
  return folded;
}

/// Their points take turns, or each step would ask for thousands of ways out.
TEST(OverlappingStarts, OfTwoBodiesNearlyInOnePlaceComeFree) {
  const IndexedMesh mesh = make_box({0.5, 0.4, 0.4}, 0.05);
  const std::vector<IndexedMesh> meshes{moved(mesh, {0, 0, 0.2}), moved(mesh, {0.05, 0.04, 0.22})};
  const Model model = make(meshes, damped(neo_hookean(1e5, 0.4), 0.002));
  State state = make_state(model, model.rest_positions);
  XpbdSolver solver(model, state, {}, {Collider{.shape = PlaneShape{}}}, {});
  solver.step(state);
  const ContactStatistics first = solver.statistics().contact;
  EXPECT_GT(10 * first.penetrating_vertices, std::ssize(model.mesh.boundary_vertices()));
  EXPECT_LT(3 * first.path_queries, first.penetrating_vertices + first.penetrating_edges);
  for (int step = 0; step < 20 * kStepsAFrame; ++step) solver.step(state);
  EXPECT_EQ(solver.statistics().unguarded_vertices, 0);
  const TriangleMesh surface = boundary_surface(model.mesh);
  EXPECT_TRUE(SelfCollisionFinder(surface, state.positions).find_pairs().empty());
}

TEST(OverlappingStarts, OfSheetsThroughThemselvesComeFree) {
  for (std::int64_t n = 0; n < test::scaled(6, 1); ++n) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(18 + n));
    std::mt19937 engine(static_cast<unsigned>(seed));
    constexpr double kLength = 1.2;
    const IndexedMesh flat = make_box({kLength, 0.6, 0.025}, 0.05);
    const Model model = make(flat, damped(neo_hookean(1e5, 0.4), 0.002));
    State state = make_state(model, folded_through_itself(flat, kLength, engine).positions);
    XpbdOptions options;
    options.gravity.setZero();
    XpbdSolver solver(model, state, {}, {}, options);
    for (int step = 0; step < 40 * kStepsAFrame; ++step) {
      solver.step(state);
      if (step == 0) {
        ASSERT_GT(solver.statistics().contact.penetrating_edges, 0) << "seed " << seed;
      }
    }
    solver.step(state);
    EXPECT_EQ(solver.statistics().unguarded_vertices, 0) << "seed " << seed;
    EXPECT_EQ(inverted_elements(model, state), 0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace selvage
