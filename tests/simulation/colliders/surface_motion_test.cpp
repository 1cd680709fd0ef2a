// Colliders that change their form by key frames: where they are, what they take along, and that nothing passes them.
#include "core/parallel.h"
#include "selvage/simulation/newton.h"
#include "simulation/cloth_bodies.h"
#include "simulation/colliders/collider_surface.h"
#include "simulation/colliders/colliders.h"
#include "test_scale.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>

namespace selvage {
namespace {

using namespace bodies;
using namespace colliders;

/// A ball of triangles.
MeshShape ball_surface(double radius, double cell) {
  const IndexedMesh ball = make_ball(radius, cell);
  const TetMesh solid(static_cast<Index>(ball.positions.size()), ball.tetrahedra);
  MeshShape shape;
  std::vector<Index> number(ball.positions.size(), kNone);
  for (VertexTuple<3> t : solid.boundary_faces()) {
    for (Index& v : t) {
      if (number[v] == kNone) {
        number[v] = static_cast<Index>(shape.positions.size());
        shape.positions.push_back(ball.positions[v]);
      }
      v = number[v];
    }
    shape.triangles.push_back(t);
  }
  return shape;
}

/// Key frames of a surface that a map of place and time deforms.
template <typename Map>
KeyframedShape keyframes_of(const MeshShape& shape, int count, double seconds, Map&& map) {
  KeyframedShape result{shape.triangles, {}, {}};
  for (int i = 0; i < count; ++i) {
    const double time = seconds * i / (count - 1);
    result.times.push_back(time);
    auto& positions = result.positions.emplace_back();
    for (const Vec3& p : shape.positions) positions.push_back(map(p, time));
  }
  return result;
}

/// Grows thin and thick, and bends to and fro, twice a second.
Vec3 dance(const Vec3& p, double time) {
  const double beat = std::sin(4 * std::numbers::pi * time);
  return {(1 + 0.3 * beat) * p[0] + 0.4 * beat * p[2] * p[2], (1 - 0.2 * beat) * p[1], (1 + 0.2 * beat) * p[2]};
}

TEST(KeyframedShape, IsLinearBetweenKeyFramesAndRestsOutside) {
  const KeyframedShape shape{{}, {1, 2, 4}, {{{0, 0, 0}}, {{1, 0, 2}}, {{1, 4, 2}}}};
  EXPECT_EQ(shape.at(0).positions[0], Vec3(0, 0, 0));
  EXPECT_EQ(shape.at(1).positions[0], Vec3(0, 0, 0));
  EXPECT_EQ(shape.at(1.5).positions[0], Vec3(0.5, 0, 1));
  EXPECT_EQ(shape.at(2).positions[0], Vec3(1, 0, 2));
  EXPECT_EQ(shape.at(3.5).positions[0], Vec3(1, 3, 2));
  EXPECT_EQ(shape.at(9).positions[0], Vec3(1, 4, 2));
}

TEST(KeyframedShape, CarriesPointsAsItsSurfaceMovesAndTurns) {
  const MeshShape box = solid_box({-1, -1, -1}, {1, 1, 1});
  const Eigen::AngleAxisd turn(0.3, Vec3(1, 2, 3).normalized());
  const Vec3 shift(0.1, 0.2, -0.4);
  KeyframedShape shape{box.triangles, {0, 1}, {box.positions, {}}};
  for (const Vec3& p : box.positions) shape.positions[1].push_back(turn * p + shift);
  const Collider collider{shape, {}, {}};
  auto prepared = prepare_colliders({&collider, 1});
  EXPECT_EQ(prepared[0].carry({3, 0, 0}), Vec3(3, 0, 0));
  prepared[0].set_step(0, 1);
  EXPECT_TRUE(prepared[0].moves(0, 1));
  for (const Vec3& p : {Vec3(1, 0.2, 0.3), Vec3(1.5, 0.1, 0), Vec3(1.2, 1.3, 1.4), Vec3(0.9, 0, 0)})
    EXPECT_NEAR((prepared[0].carry(p) - (turn * p + shift)).norm(), 0, 1e-14);
  prepared[0].set_step(1, 2);
  EXPECT_FALSE(prepared[0].moves(1, 2));
  EXPECT_FALSE(prepared[0].is_fixed());
}

TEST(KeyframedShape, TakesBodiesAlongByFrictionAsARigidMotionDoes) {
  const MeshShape plate = solid_box({-2, -2, -0.5}, {4, 2, 0});
  const Motion motion{{{0, Vec3::Zero(), 0}, {1, {0.6, 0, 0.1}, 0}}};
  const Model model = make(moved(make_box({0.4, 0.4, 0.2}, 0.2), {0, 0, 0.001}), neo_hookean(1e5));
  std::vector<Vec3> middles;
  for (const bool keyframed : {false, true}) {
    Collider collider{plate, {}, {.static_coefficient = 0.9, .dynamic_coefficient = 0.8}};
    if (keyframed) {
      collider.shape =
          keyframes_of(plate, 2, 1, [](const Vec3& p, double t) -> Vec3 { return p + t * Vec3(0.6, 0, 0.1); });
    } else {
      collider.motion = motion;
    }
    State state = make_state(model, model.rest_positions);
    XpbdSolver solver(model, state, {}, {collider}, XpbdOptions{});
    while (state.time < 1) solver.step(state);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : state.positions) middle += p / static_cast<double>(state.positions.size());
    middles.push_back(middle);
  }
  EXPECT_GT(middles[0][0], 0.5);  // from 0.2: it does not lag by more than the start
  EXPECT_NEAR((middles[0] - middles[1]).norm(), 0, 1e-6);
}

/// Exact detection over steps, of bodies and a key-framed collider, which is not judged against itself.
class DanceJudge {
 public:
  DanceJudge(const Model& model, const Collider& collider)
      : prepared_(prepare_colliders({&collider, 1})),
        size_(element_size_of(model)),
        collider_surface_(make_collider_surface(prepared_, size_)) {
    const TriangleMesh bodies = surface_of(model);
    std::vector<VertexTuple<3>> triangles(bodies.triangles().begin(), bodies.triangles().end());
    first_ = model.mesh.vertex_count();
    for (auto t : collider_surface_.triangles) {
      for (Index& v : t) v += first_;
      triangles.push_back(t);
    }
    surface_ = TriangleMesh(first_ + static_cast<Index>(collider_surface_.positions.size()), triangles);
  }

  std::int64_t pairs(const State& from, const State& to) {
    prepared_[0].set_step(from.time, to.time);
    place_keyframed(prepared_, size_, collider_surface_);
    std::vector<Vec3> start = from.positions, end = to.positions;
    start.insert(start.end(), collider_surface_.start_positions.begin(), collider_surface_.start_positions.end());
    end.insert(end.end(), collider_surface_.positions.begin(), collider_surface_.positions.end());
    const auto found = ContinuousCollisionFinder(surface_, start, end).find_pairs();
    std::int64_t count = 0;
    for (const auto& [vertex, face] : found.vertex_face)
      count += vertex < first_ || surface_.triangles()[face][0] < first_;
    for (const auto& [a, b] : found.edge_edge)
      count += surface_.edges()[a][0] < first_ || surface_.edges()[b][0] < first_;
    return count;
  }

  /// Vertices of cloth that are nearer to the collider than half of a thickness, but for a part of it.
  std::int64_t near(const State& state, double half) {
    std::int64_t count = 0;
    for (const Vec3& p : state.positions)
      count += std::get<MeshCollider>(prepared_[0].shape).find_hit(p, half).has_value();
    return count;
  }

 private:
  std::vector<PreparedCollider> prepared_;
  double size_;
  ColliderSurface collider_surface_;
  TriangleMesh surface_;
  Index first_ = 0;
};

template <typename Solver, typename Options>
std::vector<Vec3> dance_under_cloth(int steps, double time_step) {
  const double thickness = 0.006;
  const Model model = make_sheets({moved(make_cloth(1.2, 1.2, 0.1), {-0.6, -0.6, 0.31})}, cloth(thickness));
  const Collider dancer{keyframes_of(ball_surface(0.3, 0.1), 25, 1, dance), {}, {0.6, 0.5}};
  State state = make_state(model, model.rest_positions);
  Options options;
  options.time_step = time_step;
  options.contact.guarantee = true;
  Solver solver(model, state, {}, {dancer, Collider{PlaneShape{{0, 0, -0.4}, Vec3::UnitZ()}, {}, {}}}, options);
  DanceJudge judge(model, dancer);
  std::int64_t pushes = 0;
  for (int i = 0; i < steps; ++i) {
    const State before = state;
    solver.step(state);
    pushes += solver.statistics().collider_contacts + std::ssize(solver.contacts());
    EXPECT_EQ(judge.pairs(before, state), 0) << i;
    EXPECT_EQ(judge.near(state, 0.4 * thickness), 0) << i;
  }
  EXPECT_GT(pushes, 0);
  for (const Vec3& p : state.positions) EXPECT_GT(p[2], -0.41);
  return state.positions;
}

TEST(KeyframedShape, ClothOnADancerNeverMeetsIt) {
  dance_under_cloth<XpbdSolver, XpbdOptions>(static_cast<int>(test::scaled(600, 60)), 1.0 / 600);
}

TEST(KeyframedShape, ClothOnADancerNeverMeetsItByNewtonsMethod) {
  dance_under_cloth<NewtonSolver, NewtonOptions>(static_cast<int>(test::scaled(60, 20)), 1.0 / 240);
}

TEST(KeyframedShape, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<std::vector<Vec3>> ends;
  for (const int threads : {1, 3}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    ends.push_back(dance_under_cloth<XpbdSolver, XpbdOptions>(60, 1.0 / 300));
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(KeyframedShape, HoldsElementsOffToo) {
  const Model model = make(moved(make_box({0.4, 0.4, 0.2}, 0.1), {-0.2, -0.2, 0.42}), neo_hookean(5e4));
  const Collider dancer{keyframes_of(ball_surface(0.3, 0.1), 25, 1, dance), {}, {0.9, 0.8}};
  State state = make_state(model, model.rest_positions);
  XpbdOptions options;
  options.time_step = 1.0 / 600;
  options.contact.guarantee = true;
  XpbdSolver solver(model, state, {}, {dancer}, options);
  DanceJudge judge(model, dancer);
  for (int i = 0; i < test::scaled(300, 30); ++i) {
    const State before = state;
    solver.step(state);
    ASSERT_EQ(judge.pairs(before, state), 0) << i;
  }
}

TEST(KeyframedShape, RefusesWhatIsNotOneSolid) {
  const Model model = make_sheets({moved(make_cloth(1, 1, 0.5), {0, 0, 3})}, cloth());
  const State state = make_state(model, model.rest_positions);
  const MeshShape box = solid_box({-1, -1, -1}, {1, 1, 1});
  const auto refusal = [&](const KeyframedShape& shape) -> std::string {
    try {
      const XpbdSolver solver(model, state, {}, {Collider{shape, {}, {}}}, XpbdOptions{});
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  const KeyframedShape good{box.triangles, {0, 1}, {box.positions, box.positions}};
  EXPECT_EQ(refusal(good), "accepted");
  KeyframedShape bad = good;
  bad.positions[1].pop_back();
  EXPECT_NE(refusal(bad).find("collider 0: its key frame 1 has 7 vertices, the first 8"), std::string::npos);
  bad = good;
  bad.positions[1][3][2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(bad).find("key frame 1 has a position that is not finite"), std::string::npos);
  bad = good;
  for (Vec3& p : bad.positions[1]) p[0] = -p[0];
  EXPECT_NE(refusal(bad).find("key frame 1 is turned inside out"), std::string::npos);
  bad = good;
  bad.times = {1, 1};
  EXPECT_NE(refusal(bad).find("key frame 1 is not later"), std::string::npos);
  bad.times = {1};
  EXPECT_NE(refusal(bad).find("has 2 key frames and 1 times"), std::string::npos);
  bad = good;
  bad.triangles.pop_back();
  EXPECT_NE(refusal(bad).find("has 1 triangles"), std::string::npos);
}

TEST(MeshCollider, IsThickerWhereItHoldsClothOff) {
  const MeshCollider box("box", solid_box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_FALSE(box.find_hit({0, 0.1, 1.2}, 0.1));
  const Hit none{Vec3::Zero(), 0};
  const auto expect = [&](const Vec3& p, double depth, const Vec3& normal) {
    const Hit hit = box.find_hit(p, 0.1).value_or(none);
    EXPECT_NEAR(hit.depth, depth, 1e-15);
    EXPECT_NEAR((hit.normal - normal).norm(), 0, 1e-12);
  };
  expect({0, 0.1, 1.04}, 0.06, Vec3::UnitZ());
  expect({0, 0.1, 0.9}, 0.2, Vec3::UnitZ());
  expect({0, 0.1, 1}, 0.1, Vec3::UnitZ());
  expect({1.03, 0.1, 1.04}, 0.05, {0.6, 0, 0.8});
}

}  // namespace
}  // namespace selvage
