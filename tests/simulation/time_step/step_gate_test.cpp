// What holds vertices back at the end of a step, against exact continuous detection of all pairs of triangles.
#include "simulation/time_step/step_gate.h"

#include "random.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/self_collision/self_collision.h"
#include "simulation/bodies.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace selvage {
namespace {

using namespace bodies;

/// A model, where a step of it starts, and where a solver would have it end.
struct Attempt {
  Model model;
  std::vector<Vec3> start;
  std::vector<double> corrections;
  std::vector<StepVertex> end;
  Carriers carriers;
  bool is_crushed = false;  ///< see StepGate::hold_back()

  explicit Attempt(Model m) : model(std::move(m)), start(model.rest_positions), corrections(max_corrections_of(model)) {
    carriers.motions = {RigidTransform()};
    carriers.of_vertex.assign(start.size(), kNone);
    carriers.max_corrections = corrections;
    end.resize(start.size());
    for (Index v = 0; v < std::ssize(start); ++v) move(v, Vec3::Zero());
  }

  void move(Index v, const Vec3& by) {
    const Vec3 p = start[v] + by;
    end[v] = {{p[0], p[1], p[2]}, model.inverse_masses[v]};
  }
  std::vector<Vec3> positions() const {
    std::vector<Vec3> all;
    for (const StepVertex& v : end) all.push_back(Eigen::Map<const Eigen::Vector3d>(v.position));
    return all;
  }

  /// Statistics; none where nothing was violated.
  /// @param may_be_pressed  flat elements, on and on
  std::optional<GateStatistics> pass(bool may_be_pressed = false) {
    ContactFinder finder(model.mesh, model.rest_positions, start);
    finder.begin_step(start);
    StepGate gate(model, model.mesh.vertex_count());
    const std::vector<Vec3> still(start.size(), Vec3::Zero());
    const Step step{1, 0, 1.0 / 300, start, still};
    if (!gate.is_violated(finder, step, end, false)) return {};
    const GateStatistics statistics = gate.hold_back(finder, step, carriers, is_crushed, end);
    const bool is_left = gate.is_violated(finder, step, end, false);
    EXPECT_TRUE(is_left == (statistics.impacts_left > 0) || may_be_pressed);
    return statistics;
  }

  /// Momentum and angular momentum of the displacements.
  std::pair<Vec3, Vec3> momenta() const {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
    const std::vector<Vec3> now = positions();
    for (Index v = 0; v < std::ssize(start); ++v) {
      linear += mass(model, v) * (now[v] - start[v]);
      angular += mass(model, v) * start[v].cross(now[v] - start[v]);
    }
    return {linear, angular};
  }

  std::int64_t impacts() const {
    const TriangleMesh surface = boundary_surface(model.mesh);
    SelfCollisionOptions options;
    options.method = CullingMethod::kBvh;
    const ContinuousPairs pairs = ContinuousCollisionFinder(surface, start, positions(), options).find_pairs();
    return std::ssize(pairs.vertex_face) + std::ssize(pairs.edge_edge);
  }
  std::int64_t inverted() const { return inverted_elements(model, State{positions(), {}, 0, 0}); }
};

Attempt two_boxes(double gap) {
  const IndexedMesh box = make_box({0.3, 0.3, 0.3}, 0.1);
  return Attempt(make(std::array{box, moved(box, {0.07, 0.05, 0.3 + gap})}, neo_hookean(1e5)));
}

TEST(StepGate, LeavesAStepInWhichNothingMeetsAsItIs) {
  Attempt attempt = two_boxes(0.02);
  for (Index v = 0; v < std::ssize(attempt.start); ++v) attempt.move(v, {0.5, 0, 0.25 * attempt.start[v][2]});
  const std::vector<Vec3> before = attempt.positions();
  EXPECT_FALSE(attempt.pass());
  EXPECT_EQ(attempt.positions(), before);
}

TEST(StepGate, KeepsMomentumAndAngularMomentumOfBodiesThatMeet) {
  Attempt attempt = two_boxes(0.01);
  test::Random random(3);
  const Body& upper = attempt.model.bodies[1];
  for (Index v = upper.first_vertex; v < upper.first_vertex + upper.vertex_count; ++v)
    attempt.move(v, Vec3(0.01, 0, -0.04) + random.vector(0.01));
  EXPECT_GT(attempt.impacts(), 10);
  const auto [linear, angular] = attempt.momenta();
  const auto statistics = attempt.pass();
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->impacts_left, 0);
  EXPECT_GT(statistics->held_back_vertices, 0);
  EXPECT_EQ(attempt.impacts(), 0);
  const auto [linear_after, angular_after] = attempt.momenta();
  EXPECT_LT((linear_after - linear).norm(), 1e-12 * linear.norm());
  EXPECT_LT((angular_after - angular).norm(), 1e-12 * angular.norm());
}

TEST(StepGate, KeepsElementsThatAreUprightUpright) {
  test::Random random(5);
  std::int64_t inverted = 0;
  for (std::int64_t n = 0; n < test::scaled(100, 5); ++n) {
    Attempt attempt(make(make_box({0.3, 0.3, 0.3}, 0.1), neo_hookean(1e5)));
    for (Index v = 0; v < std::ssize(attempt.start); ++v) attempt.move(v, random.vector(random.within(0, 0.15)));
    inverted += attempt.inverted();
    attempt.pass();
    EXPECT_EQ(attempt.inverted(), 0);
    EXPECT_EQ(attempt.impacts(), 0);
  }
  EXPECT_GT(inverted, 100);
}

/// Bodies of several shapes that do not meet, each of which moves somewhere and trembles.
Attempt random_attempt(std::uint64_t seed) {
  test::Random random(seed);
  const std::array shapes{make_box({0.3, 0.2, 0.1}, 0.1), make_ball(0.15, 0.07), make_torus(0.2, 0.07, 0.07),
                          make_box({0.5, 0.5, 0.03}, 0.1)};
  std::vector<IndexedMesh> meshes;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(0.55 * (i & 1), 0.55 * (i >> 1 & 1), 0.3 * (i >> 2));
    meshes.push_back(moved(shapes[random.below(shapes.size())], corner));
  }
  Attempt attempt(make(meshes, neo_hookean(1e5)));
  const double speed = random.within(0.01, 1), noise = random.within(0, 0.1);
  for (const Body& body : attempt.model.bodies) {
    const Vec3 by = random.vector(speed);
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      attempt.move(v, by + random.vector(noise));
  }
  return attempt;
}

TEST(StepGate, LeavesNothingThatMeetsAndNothingInvertedHoweverBodiesMove) {
  std::int64_t met = 0;
  const std::int64_t count = test::scaled(40, 4);
  for (std::int64_t n = 0; n < count; ++n) {
    Attempt attempt = random_attempt(test::seed(static_cast<std::uint64_t>(n)));
    const TriangleMesh surface = boundary_surface(attempt.model.mesh);
    if (!SelfCollisionFinder(surface, attempt.start).find_pairs().empty()) continue;
    met += attempt.impacts() > 0;
    const auto statistics = attempt.pass();
    ASSERT_TRUE(!statistics || statistics->impacts_left == 0) << n;
    EXPECT_EQ(attempt.impacts(), 0) << n;
    EXPECT_EQ(attempt.inverted(), 0) << n;
  }
  EXPECT_GT(met, test::quota(count, 0.4));
}

/// Flat boxes in a row: the first would only meet the second, which, taken along, meets the next. Also where impacts
/// are looked for last.
TEST(StepGate, LeavesNothingThatMeetsOnlyWhenOthersAreHeldBack) {
  std::vector<IndexedMesh> row;
  for (int i = 0; i < 4; ++i) row.push_back(moved(make_box({0.3, 0.3, 0.002}, 0.1), {0, 0, 0.003 * i}));
  for (const bool is_crushed : {false, true}) {
    Attempt attempt(make(row, neo_hookean(1e5)));
    attempt.is_crushed = is_crushed;
    for (Index v = 0; v < attempt.model.bodies[1].first_vertex; ++v) attempt.move(v, {0, 0, 0.0038});
    const auto statistics = attempt.pass();
    ASSERT_TRUE(statistics);
    EXPECT_EQ(statistics->impacts_left, 0);
    EXPECT_EQ(attempt.impacts(), 0);
    EXPECT_EQ(attempt.inverted(), 0);
  }
}

TEST(StepGate, HoldsBackTheSameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> first;
  for (const int threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Attempt attempt = random_attempt(17);
    ASSERT_TRUE(attempt.pass());
    if (first.empty()) first = attempt.positions();
    EXPECT_EQ(attempt.positions(), first);
  }
}

/// A layer of elements is pressed flat between two carriers that shear it: neither takes all of it along.
void expect_bent(const Vec3& size) {
  Attempt attempt(make(make_box(size, 0.1), neo_hookean(1e5)));
  attempt.carriers.motions.push_back({Eigen::Matrix3d::Identity(), Vec3(0.03, 0, 0)});
  for (Index v = 0; v < std::ssize(attempt.start); ++v) {
    const bool is_upper = attempt.start[v][2] > 0.05;
    attempt.carriers.of_vertex[v] = is_upper ? 1 : 0;
    attempt.move(v, {0, 0, is_upper ? -10.0 : 0.0});
  }
  EXPECT_GT(attempt.inverted(), 10);
  const auto statistics = attempt.pass();
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->impacts_left, 0);
  EXPECT_EQ(attempt.inverted(), 0);
  const std::vector<Vec3> now = attempt.positions();
  for (Index v = 0; v < std::ssize(attempt.start); ++v)
    EXPECT_NEAR(now[v][0] - attempt.start[v][0], attempt.start[v][2] > 0.05 ? 0.03 : 0, 0.001);
}

TEST(StepGate, BendsAZoneBetweenCarriersThatMoveApart) {
  expect_bent({0.3, 0.3, 0.1});
}

/// So many touches that not all of them lead the vertices around them.
TEST(StepGate, BendsALargeZoneBetweenCarriersThatMoveApart) {
  expect_bent({1.5, 1.5, 0.1});
}

/// Elements as flat as they may get are pressed on where carriers close in: else one of these would get into them.
TEST(StepGate, PressesFlatElementsBetweenCarriersThatCloseIn) {
  Attempt attempt(make(make_box({0.1, 0.1, 3}, 0.1), neo_hookean(1e5)));
  double height = 0;
  for (Vec3& p : attempt.start) {
    p[2] = 0.05 * p[2] - (p[2] > 1.05 ? 0.0481 * 0.1 : 0);  // one layer in the middle is as flat as may be
    height = std::max(height, p[2]);
  }
  const double way = -0.05 * height;
  attempt.carriers.motions.push_back({Eigen::Matrix3d::Identity(), Vec3(0, 0, way)});
  for (Index v = 0; v < std::ssize(attempt.start); ++v) {
    const double z = attempt.start[v][2];
    if (z == 0) attempt.carriers.of_vertex[v] = 0;
    if (z == height) attempt.carriers.of_vertex[v] = 1;
    attempt.move(v, {0, 0, z > 0.5 * height ? -0.5 * height : 0});
  }
  EXPECT_GT(attempt.inverted(), 3);
  const auto statistics = attempt.pass(true);
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->impacts_left, 0);
  EXPECT_EQ(attempt.inverted(), 0);
  const std::vector<Vec3> now = attempt.positions();
  for (Index v = 0; v < std::ssize(attempt.start); ++v)
    EXPECT_NEAR(now[v][2] - attempt.start[v][2], way * attempt.start[v][2] / height, 1e-6);
}

TEST(StepGate, MovesZonesWithWhatCarriesThem) {
  Attempt attempt = two_boxes(0.01);
  const Body& upper = attempt.model.bodies[1];
  attempt.carriers.motions.push_back({Eigen::Matrix3d::Identity(), Vec3(0, 0, -0.05)});
  for (Index v = upper.first_vertex; v < upper.first_vertex + upper.vertex_count; ++v) {
    attempt.move(v, {0, 0, -0.05});
    attempt.end[v].inverse_mass = 0;
    attempt.carriers.of_vertex[v] = 1;
  }
  const std::vector<Vec3> wanted = attempt.positions();
  const auto statistics = attempt.pass();
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->impacts_left, 0);
  EXPECT_EQ(attempt.impacts(), 0);
  const std::vector<Vec3> now = attempt.positions();
  for (Index v = upper.first_vertex; v < upper.first_vertex + upper.vertex_count; ++v) EXPECT_EQ(now[v], wanted[v]);
}

TEST(StepGate, EndsAndSaysSoWhereHeldVerticesRunIntoOneAnother) {
  Attempt attempt = two_boxes(0.01);
  attempt.carriers.motions.push_back({Eigen::Matrix3d::Identity(), Vec3(0, 0, -0.05)});
  for (Index v = 0; v < std::ssize(attempt.start); ++v) {
    const bool is_upper = v >= attempt.model.bodies[1].first_vertex;
    if (is_upper) attempt.move(v, {0, 0, -0.05});
    attempt.end[v].inverse_mass = 0;
    attempt.carriers.of_vertex[v] = is_upper ? 1 : 0;
  }
  const auto statistics = attempt.pass();
  ASSERT_TRUE(statistics);
  EXPECT_GT(statistics->impacts_left, 0);
}

}  // namespace
}  // namespace selvage
