// What a guarantee promises, step by step, against exact continuous detection of all pairs on the stored positions.
#include "contact/input/collider_triangles.h"
#include "random.h"
#include "selvage/self_collision/continuous_collision.h"
#include "selvage/simulation/newton.h"
#include "selvage/simulation/vbd.h"
#include "simulation/bodies.h"
#include "simulation/colliders/collider_surface.h"
#include "simulation/guarded_steps.h"
#include "test_scale.h"

#include <tbb/global_control.h>

#include <numbers>

namespace selvage {
namespace {

using namespace bodies;

template <typename Options>
Options guaranteed(double time_step = 1.0 / 120) {
  Options options;
  options.time_step = time_step;
  options.contact.guarantee = true;
  return options;
}

/// Exact detection over steps, with nothing that a guarantee uses but the predicates: bodies, and the edges, corners
/// and faces of colliders.
class Judge {
 public:
  Judge(const Model& model, std::span<const Collider> colliders) : colliders_(prepare_colliders(colliders)) {
    collider_surface_ = make_collider_surface(colliders_, element_size_of(model));
    std::vector<VertexTuple<3>> triangles = collider_surface_.triangles;
    for (auto& t : triangles)
      for (Index& v : t) v += model.mesh.vertex_count();
    surface_ =
        surface_with_colliders(model.mesh, triangles, model.rest_positions.size() + collider_surface_.positions.size());
    options_ = options_with_colliders(model.mesh.boundary_face_count(), surface_);
    options_.method = CullingMethod::kBvh;
  }

  /// Whether no triangles meet.
  bool is_free(const State& state) const {
    return SelfCollisionFinder(surface_, all_of(state), options_).find_pairs().empty();
  }

  std::int64_t pairs(const State& from, const State& to) const {
    const auto found = ContinuousCollisionFinder(surface_, all_of(from), all_of(to), options_).find_pairs();
    return std::ssize(found.vertex_face) + std::ssize(found.edge_edge);
  }

 private:
  std::vector<Vec3> all_of(const State& state) const {
    std::vector<Vec3> all = state.positions;
    for (std::size_t i = 0; i < collider_surface_.positions.size(); ++i)
      all.push_back(
          colliders_[collider_surface_.collider_of_vertices[i]].motion.at(state.time)(collider_surface_.positions[i]));
    return all;
  }

  std::vector<PreparedCollider> colliders_;
  ColliderSurface collider_surface_;
  TriangleMesh surface_;
  SelfCollisionOptions options_;
};

/// Bodies of several shapes, flat ones and thin ones among them, that fly at one another over a floor with a block.
struct Flight {
  Model model;
  State state;
  std::vector<Collider> colliders;

  explicit Flight(std::uint64_t seed) {
    test::Random random(seed);
    const std::array shapes{make_box({0.3, 0.2, 0.1}, 0.1), make_ball(0.14, 0.08), make_torus(0.2, 0.06, 0.1),
                            make_box({0.4, 0.4, 0.02}, 0.1), make_box({0.45, 0.02, 0.02}, 0.05)};
    std::vector<IndexedMesh> meshes;
    for (int i = 0; i < 6; ++i)
      meshes.push_back(
          moved(shapes[random.below(shapes.size())], {0.8 * (i & 1), 0.8 * (i >> 1 & 1), 0.5 + 0.35 * (i >> 2)}));
    model = make(meshes, neo_hookean(random.below(2) == 0 ? 2e4 : 1e6, 0.4));
    state = make_state(model, model.rest_positions);
    const double speed = random.within(1, 30);
    for (const Body& body : model.bodies) {
      const Vec3 by = random.vector(speed) - Vec3(0, 0, 0.3 * speed);
      for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v) state.velocities[v] = by;
    }
    colliders.push_back({PlaneShape{{0, 0, 0}, {0, 0, 1}}, {}, {}});
    const IndexedMesh block = make_box({0.3, 0.3, 0.2}, 0.3);
    MeshShape shape;
    const TetMesh solid(static_cast<Index>(block.positions.size()), block.tetrahedra);
    shape.triangles.assign(solid.boundary_faces().begin(), solid.boundary_faces().end());
    for (const Vec3& p : block.positions) shape.positions.push_back(p + Vec3(0.3, 0.3, 0.01));
    colliders.push_back({shape, {}, {}});
  }
};

template <typename Solver, typename Options>
void expect_nothing_meets(std::uint64_t seed, int steps, std::int64_t& met, std::int64_t& held) {
  Flight scene(seed);
  const Judge judge(scene.model, scene.colliders);
  Solver solver(scene.model, scene.state, {}, scene.colliders, guaranteed<Options>());
  if (!judge.is_free(scene.state)) return;
  expect_free_steps(judge, solver, scene.state, steps, seed, met, held);
}

TEST(Guarantee, HoldsWhateverFliesAtWhatWithXpbd) {
  std::int64_t met = 0, held = 0;
  for (std::int64_t n = 0; n < test::scaled(100, 4); ++n)
    expect_nothing_meets<XpbdSolver, XpbdOptions>(test::seed(static_cast<std::uint64_t>(n)), 40, met, held);
  EXPECT_GE(met, test::scaled(10, 1));
  EXPECT_GE(held, test::scaled(10, 1));
}

TEST(Guarantee, HoldsWhateverFliesAtWhatWithVbd) {
  std::int64_t met = 0, held = 0;
  for (std::int64_t n = 0; n < test::scaled(30, 1); ++n)
    expect_nothing_meets<VbdSolver, VbdOptions>(test::seed(static_cast<std::uint64_t>(n)), 25, met, held);
  EXPECT_GE(held, test::scaled(10, 0));
}

TEST(Guarantee, HoldsWhateverFliesAtWhatWithNewton) {
  std::int64_t met = 0, held = 0;
  for (std::int64_t n = 0; n < test::scaled(8, 1); ++n)
    expect_nothing_meets<NewtonSolver, NewtonOptions>(test::seed(static_cast<std::uint64_t>(n)), 12, met, held);
  EXPECT_GE(met + held, 0);
}

// A step in which nothing would meet has the bits that it has without any holding back.
TEST(Guarantee, LeavesStepsInWhichNothingMeetsAsTheyAre) {
  std::int64_t same = 0, other = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(test::scaled(20, 2)); ++seed) {
    Flight scene(seed);
    const Judge judge(scene.model, scene.colliders);
    if (!judge.is_free(scene.state)) continue;
    for (int i = 0; i < 30; ++i) {
      XpbdOptions unguarded = guaranteed<XpbdOptions>();
      unguarded.contact.guarantee = unguarded.contact.hold_back = false;
      State without = scene.state;
      XpbdSolver free(scene.model, scene.state, {}, scene.colliders, unguarded);
      XpbdSolver guarded(scene.model, scene.state, {}, scene.colliders, guaranteed<XpbdOptions>());
      const State before = scene.state;
      free.step(without);
      guarded.step(scene.state);
      if (judge.pairs(before, without) > 0 || guarded.statistics().hold_back_rounds > 0) {
        ++other;
        continue;
      }
      EXPECT_TRUE(same_bits(scene.state, without)) << seed << ", " << i;
      EXPECT_EQ(guarded.statistics().held_back_vertices, 0);
      ++same;
    }
  }
  EXPECT_GT(same, 10);
  EXPECT_GT(other, 0);
}

TEST(Guarantee, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<State> ends;
  for (const int threads : {1, 2, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Flight scene(3);
    VbdSolver solver(scene.model, scene.state, {}, scene.colliders, guaranteed<VbdOptions>());
    for (int i = 0; i < 20; ++i) solver.step(scene.state);
    ends.push_back(scene.state);
  }
  EXPECT_TRUE(same_bits(ends[0], ends[1]));
  EXPECT_TRUE(same_bits(ends[0], ends[2]));
}

// Faces in one plane, edges on edges, a hair apart: all signs are near 0.
TEST(Guarantee, HoldsForStacksThatAreCoplanar) {
  const IndexedMesh tile = make_box({0.3, 0.3, 0.05}, 0.1);
  for (const double gap : {1e-3, 1e-9, 0x1p-52}) {
    std::vector<IndexedMesh> tiles;
    for (int i = 0; i < 6; ++i) tiles.push_back(moved(tile, {0, 0, (0.05 + gap) * i}));
    const Model model = make(tiles, neo_hookean(1e5, 0.4));
    State state = make_state(model, model.rest_positions);
    const std::vector<Collider> floor{{PlaneShape{{0, 0, 0}, {0, 0, 1}}, {}, {}}};
    const Judge judge(model, floor);
    const bool starts_free = judge.is_free(state);
    XpbdSolver solver(model, state, {}, floor, guaranteed<XpbdOptions>());
    for (int i = 0; i < 40; ++i) {
      const State before = state;
      solver.step(state);
      if (starts_free) {
        ASSERT_EQ(judge.pairs(before, state), 0) << gap << ", " << i;
      }
    }
    EXPECT_TRUE(starts_free || gap < 1e-6);
  }
}

// What starts tangled is let out, and nothing meets any more once it is.
TEST(Guarantee, BeginsWhenATangledStartIsOut) {
  const IndexedMesh box = make_box({0.4, 0.4, 0.4}, 0.1);
  const Model model = make(std::array{box, moved(box, {0.05, 0.03, 0.33})}, neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);
  XpbdOptions options = guaranteed<XpbdOptions>();
  options.gravity.setZero();
  XpbdSolver solver(model, state, {}, {}, options);
  const Judge judge(model, {});
  EXPECT_FALSE(judge.is_free(state));
  std::int64_t unguarded = 0, guarded = 0;
  for (int i = 0; i < 200; ++i) {
    const State before = state;
    solver.step(state);
    if (solver.statistics().unguarded_vertices > 0) {
      ++unguarded;
      EXPECT_EQ(guarded, 0) << "tangled again in step " << i;
      continue;
    }
    ++guarded;
    EXPECT_EQ(judge.pairs(before, state), 0) << i;
    EXPECT_TRUE(judge.is_free(state));
  }
  EXPECT_GT(unguarded, 0);
  EXPECT_GT(guarded, 50);
}

/// Two boxes held by their far sides that are led through one another.
TEST(Guarantee, SaysWhereHandlesLeaveNoRoomAndLeavesTheState) {
  const IndexedMesh box = make_box({0.2, 0.2, 0.2}, 0.1);
  const Model model = make(std::array{box, moved(box, {0.02, 0.01, 0.3})}, neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);
  Handle below = hold(model, [](const Vec3& p) { return p[2] < 0.25; });
  Handle above = hold(model, [](const Vec3& p) { return p[2] > 0.25; });
  above.motion.keyframes = {{0, Vec3::Zero(), 0}, {1, Vec3(0, 0, -0.3), 0}};
  XpbdSolver solver(model, state, {below, above}, {}, guaranteed<XpbdOptions>());
  State before = state;
  try {
    for (int i = 0; i < 120; ++i) {
      before = state;
      solver.step(state);
    }
    FAIL() << "led through one another";
  } catch (const PinchError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("near ["), std::string::npos) << text;
    EXPECT_NE(text.find("'body0'"), std::string::npos) << text;
    EXPECT_NE(text.find("'body1'"), std::string::npos) << text;
    EXPECT_GT(state.steps, 20);
    EXPECT_TRUE(same_bits(state, before));
  }
}

TEST(Guarantee, CountsInvertedElementsAndFacesOfColliders) {
  // A box whose inner element is inverted and whose surface meets nothing is guarded all the same.
  const Model model = make(make_box({0.3, 0.3, 0.3}, 0.1), neo_hookean(1e5, 0.4));
  State state = make_state(model, model.rest_positions);
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    if ((state.positions[v] - Vec3(0.1, 0.1, 0.1)).norm() < 1e-6) state.positions[v] = Vec3(0.25, 0.25, 0.25);
  ASSERT_GT(inverted_elements(model, state), 0);
  XpbdSolver solver(model, state, {}, {}, guaranteed<XpbdOptions>());
  solver.step(state);
  EXPECT_EQ(solver.statistics().unguarded_vertices, 0);
}

TEST(Guarantee, RefusesOptionsUnderWhichItCannotBe) {
  const Model model = make(make_ball(0.1, 0.05), neo_hookean(1e5));
  const State state = make_state(model, model.rest_positions);
  for (int i = 0; i < 5; ++i) {
    XpbdOptions options = guaranteed<XpbdOptions>();
    if (i == 0) options.contact.mode = DetectionMode::kCcd;
    if (i == 1) options.contact.mode = DetectionMode::kOff;
    if (i == 2) options.contact.hold_back = false;
    if (i == 3) options.contact.detect_edges = false;
    if (i == 4) options.contact.interior_points = true;
    expect_error("guarantee: needs the hybrid mode", [&] { XpbdSolver(model, state, {}, {}, options); });
  }
}

}  // namespace
}  // namespace selvage
