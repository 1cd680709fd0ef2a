// The scenes at a small size, for as many frames as it takes until what they show has happened.
#include "scene/scene_solver.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/scene/run.h"
#include "selvage/self_collision/self_collision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

namespace selvage {
namespace {

namespace fs = std::filesystem;

/// A place in a scene and what stands there instead, as JSON.
using Changes = std::vector<std::pair<const char*, const char*>>;

/// At its scale "small", with changes.
Scene load(const std::string& name, const Changes& changes = {}) {
  std::vector<std::string> assignments;
  for (const auto& [place, value] : changes) assignments.push_back(std::string(place) + "=" + value);
  return read_scene(fs::path(SELVAGE_SCENES) / (name + ".json"), "small", assignments);
}

/// A run of a scene that stays in memory.
class Play {
 public:
  explicit Play(Scene scene) : scene_(std::move(scene)), state_(scene_.initial_state) {}

  void step(int count) {
    for (int i = 0; i < count; ++i) {
      const std::int64_t frame = state_.steps / scene_.substeps + 1;
      const bool contact = frame > scene_.contact_from_frame;
      if (!solver_ || contact != with_contact_) {
        solver_ = std::make_unique<SceneSolver>(scene_, contact);
        with_contact_ = contact;
      }
      solver_->step(state_);
      for (const std::int64_t found : solver_->statistics().contact.contacts) contacts_ += found;
    }
  }
  void run_frames(int count) { step(count * scene_.substeps); }

  const Scene& scene() const { return scene_; }
  const State& state() const { return state_; }
  std::int64_t contacts() const { return contacts_; }  ///< found in all steps so far
  BoundaryPathFinder<3> finder() const { return {scene_.model.mesh, state_.positions}; }

  Index body_of(Index vertex) const {
    Index b = 0;
    while (vertex >= scene_.model.bodies[b].first_vertex + scene_.model.bodies[b].vertex_count) ++b;
    return b;
  }

  Vec3 middle_of(std::size_t body) const {
    const Body& b = scene_.model.bodies[body];
    Vec3 sum = Vec3::Zero();
    for (Index v = b.first_vertex; v < b.first_vertex + b.vertex_count; ++v) sum += state_.positions[v];
    return sum / b.vertex_count;
  }

 private:
  Scene scene_;
  State state_;
  std::unique_ptr<SceneSolver> solver_;
  bool with_contact_ = false;
  std::int64_t contacts_ = 0;
};

struct Tangle {
  std::int64_t vertices = 0, inverted = 0;
  double deepest = 0;
};

Tangle tangle_of(const Play& play) {
  const auto finder = play.finder();
  Tangle tangle;
  tangle.inverted = finder.defects().inverted_elements;
  const auto queries = finder.find_penetrating_vertices();
  std::set<Index> vertices;
  for (const auto& query : queries) vertices.insert(query.source[0]);
  for (const auto& path : finder.find_paths(queries))
    if (path.status == PathStatus::kFound) tangle.deepest = std::max(tangle.deepest, path.distance);
  tangle.vertices = std::ssize(vertices);
  return tangle;
}

bool crosses_itself(const Play& play) {
  const TriangleMesh surface = boundary_surface(play.scene().model.mesh);
  return SelfCollisionFinder(surface, play.state().positions).has_pairs();
}

/// Pairs of bodies of which a vertex of the first is in the second by more than 5 mm.
std::set<std::pair<Index, Index>> interlocked_pairs(const Play& play) {
  const auto finder = play.finder();
  const auto queries = finder.find_penetrating_vertices();
  const auto paths = finder.find_paths(queries);
  std::set<std::pair<Index, Index>> pairs;
  for (std::size_t i = 0; i < queries.size(); ++i)
    if (paths[i].status == PathStatus::kFound && paths[i].distance > 0.005)
      pairs.emplace(play.body_of(queries[i].source[0]),
                    play.body_of(play.scene().model.mesh.elements()[queries[i].element][0]));
  return pairs;
}

TEST(SceneRuns, ACubeSlidesDownByExactPathsAndIsPulledUpByThoseOfTheRestPose) {
  Play exact(load("sliding_cube")), by_rest(load("sliding_cube", {{"/contact/rule", "\"rest-pose\""}}));
  for (Play* play : {&exact, &by_rest}) play->run_frames(18);
  const double landed_exact = exact.middle_of(1)[2], landed_by_rest = by_rest.middle_of(1)[2];
  for (Play* play : {&exact, &by_rest}) play->run_frames(7);
  // By how far is a regression mark; the directions are the paper's.
  EXPECT_LT(exact.middle_of(1)[2], landed_exact - 0.1);
  EXPECT_GT(by_rest.middle_of(1)[2], landed_by_rest + 0.1);
  const Tangle end = tangle_of(exact);
  EXPECT_EQ(end.inverted, 0);
  EXPECT_LT(end.deepest, 1e-3);
}

/// Soft rods that fall crosswise on one another in a gutter, at 10 m/s: a third of an element a step.
Scene falling_rods(DetectionMode mode) {
  Scene scene = parse_scene(R"({
    "selvage_scene": 1, "frames": 30, "substeps": 5, "iterations": 5, "damping": 1, "max_speed": 30,
    "bodies": [{
      "mesh": {"shape": "rod", "length": 1.6, "radius": 0.1, "elements": 800},
      "instances": {"list": [
        {"translate": [0, 0, 1.3]},
        {"translate": [0, 0, 1.6], "rotate": {"axis": [0, 0, 1], "degrees": 80}},
        {"translate": [0, 0, 1.9]},
        {"translate": [0, 0, 2.2], "rotate": {"axis": [0, 0, 1], "degrees": 80}}
      ]},
      "material": {"youngs_modulus": 3e5, "poisson_ratio": 0.3, "damping": 0.001},
      "velocity": [0, 0, -10]
    }],
    "colliders": [
      {"plane": {"normal": [0.7, 0, 1], "point": [0, 0, 0]}},
      {"plane": {"normal": [-0.7, 0, 1], "point": [0, 0, 0]}}
    ]
  })",
                            "rods.json");
  scene.options.contact.mode = mode;
  return scene;
}

// 0.01 m, a tenth of the radius, is a regression mark.
TEST(SceneRuns, RodsThatFallHardNeitherPenetrateNorInvert) {
  Play play(falling_rods(DetectionMode::kHybrid));
  for (int frame = 1; frame <= 20; ++frame) {
    play.run_frames(1);
    const Tangle tangle = tangle_of(play);
    EXPECT_EQ(tangle.inverted, 0) << frame;
    EXPECT_LT(tangle.deepest, 0.01) << frame;
  }
  Play through(falling_rods(DetectionMode::kOff));
  through.run_frames(10);
  EXPECT_GT(tangle_of(through).deepest, 0.05);
}

/// A scene of the paper at a small size. The three bounds are regression marks, measured and rounded outward: no law of
/// physics gives them.
struct SmallScene {
  const char* name;
  Changes changes;
  int frames;
  std::int64_t min_contacts;              ///< found in all frames
  std::int64_t max_penetrating_vertices;  ///< at the end
  double max_depth;                       ///< of these [m]
};

void PrintTo(const SmallScene& scene, std::ostream* out) {
  *out << scene.name;
}

const Changes kTwoOctopi{{"/bodies/0/instances/grid/counts", "[1, 1, 2]"},
                         {"/bodies/0/instances/grid/spacing", "[4.1, 4.1, 1.2]"},
                         {"/bodies/0/instances/jitter/degrees", "8"},
                         {"/bodies/0/translate", "[-2.1, 0, 1.2]"}};

class SmallScenes : public testing::TestWithParam<SmallScene> {};

TEST_P(SmallScenes, EndWithoutInvertedElementsAndWithFewAndShallowPenetrations) {
  Play play(load(GetParam().name, GetParam().changes));
  play.run_frames(GetParam().frames);
  EXPECT_GT(play.contacts(), GetParam().min_contacts);
  const Tangle end = tangle_of(play);
  EXPECT_LE(end.vertices, GetParam().max_penetrating_vertices);
  EXPECT_LT(end.deepest, GetParam().max_depth);
  EXPECT_EQ(end.inverted, 0);
}

INSTANTIATE_TEST_SUITE_P(
    OfThePaper, SmallScenes,
    testing::Values(
        SmallScene{"twisted_beam", {{"/bodies/0/mesh/cell", "0.06"}}, 60, 10'000, 20, 1e-3},
        SmallScene{"twisted_rods", {{"/bodies/0/mesh/cell", "0.06"}}, 60, 40'000, 20, 1e-3},
        SmallScene{"nested_knot", {{"/bodies/0/mesh/cell", "0.014"}, {"/substeps", "10"}}, 60, 1'000, 20, 2e-3},
        SmallScene{
            "two_balls", {{"/bodies/0/mesh/tentacles", "6"}, {"/bodies/0/mesh/elements", "4600"}}, 8, 50'000, 30, 2e-3},
        SmallScene{"balls_16",
                   {{"/bodies/0/mesh/tentacles", "5"},
                    {"/bodies/0/mesh/elements", "3800"},
                    {"/bodies/0/instances/grid/counts", "[1, 1, 2]"},
                    {"/bodies/0/translate", "[0, 0, 0.2]"}},
                   45,
                   10'000,
                   20,
                   1e-3},
        SmallScene{"long_noodle",
                   {{"/bodies/0/mesh/length", "5"},
                    {"/bodies/0/mesh/cell", "0.06"},
                    {"/colliders/0/bowl/radius", "0.5"},
                    {"/colliders/0/bowl/centre", "[0, 0, 0.6]"}},
                   45,
                   40'000,
                   20,
                   1e-3},
        SmallScene{"octopi_16",
                   {{"/bodies/0/instances/grid/counts", "[1, 1, 2]"},
                    {"/bodies/0/instances/grid/spacing", "[4.2, 4.2, 1.2]"},
                    {"/bodies/0/instances/jitter/degrees", "8"},
                    {"/bodies/0/translate", "[2.2, 2.2, 1.2]"},
                    {"/colliders/0/box/max", "[4.4, 4.4, 100]"}},
                   50,
                   10'000,
                   20,
                   1e-3},
        SmallScene{"octopi_6_implicit",
                   {{"/bodies/0/mesh", R"({"shape": "ball", "radius": 0.6, "cell": 0.2})"},
                    {"/bodies/0/translate", "[0, 0, 0.7]"},
                    {"/bodies/0/instances/grid/counts", "[1, 1, 2]"},
                    {"/bodies/0/instances/grid/spacing", "[4.1, 4.1, 1.3]"}},
                   30,
                   1'000,
                   0,
                   1e-3},
        SmallScene{"octopi_8_hybrid", kTwoOctopi, 60, 40'000, 20, 1e-3},
        SmallScene{"octopi_8_dcd", kTwoOctopi, 60, 40'000, 20, 2e-3}),
    [](const auto& param) { return param.param.name; });

/// Of radius 0.5 without its tentacles, by plates that come to 0.1 from its middle.
TEST(SceneRuns, AFlattenedBallReturnsToItsShape) {
  Play play(load("flattened_ball", {{"/bodies/0/mesh/tentacles", "6"}, {"/bodies/0/mesh/elements", "3000"}}));
  const std::vector<Vec3> rest = play.state().positions;
  play.run_frames(31);
  for (const Vec3& p : play.state().positions) EXPECT_LE(std::abs(p[2]), 0.1 + 1e-9);
  play.run_frames(29);
  const Tangle end = tangle_of(play);
  EXPECT_EQ(end.inverted, 0);
  EXPECT_LT(end.deepest, 1e-3);
  double changes = 0, lengths = 0;
  for (const auto& e : play.scene().model.mesh.elements())
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) {
        const double now = (play.state().positions[e[a]] - play.state().positions[e[b]]).norm();
        const double before = (rest[e[a]] - rest[e[b]]).norm();
        changes += (now - before) * (now - before);
        lengths += before * before;
      }
  EXPECT_LT(std::sqrt(changes / lengths), 0.04);  // a regression mark: the ball still swings
}

/// CCD alone never finds a penetration that it missed once (SPB figure 9). 10 frames are a regression mark.
TEST(SceneRuns, RodsStayInterlockedByCcdAloneAndNeverByTheHybrid) {
  int frames_locked = 0, frames_locked_by_both = 0;
  Play by_ccd(falling_rods(DetectionMode::kCcd)), by_both(falling_rods(DetectionMode::kHybrid));
  for (int frame = 1; frame <= 30; ++frame) {
    for (Play* play : {&by_ccd, &by_both}) play->run_frames(1);
    frames_locked += !interlocked_pairs(by_ccd).empty();
    frames_locked_by_both += !interlocked_pairs(by_both).empty();
  }
  EXPECT_GT(frames_locked, 10);
  EXPECT_EQ(frames_locked_by_both, 0);
}

/// One loop of the noodle.
TEST(SceneRuns, ATangledNoodleIsFreeWithinTenSteps) {
  Play play(load("tangled_noodle", {{"/bodies/0/mesh/length", "3"}, {"/bodies/0/poses/1/crossings", "1"}}));
  EXPECT_GT(tangle_of(play).vertices, 20);
  EXPECT_GT(tangle_of(play).deepest, 0.05);
  play.step(10);
  EXPECT_EQ(tangle_of(play).vertices, 0);
  play.step(30);
  const Tangle end = tangle_of(play);
  EXPECT_EQ(end.vertices, 0);
  EXPECT_EQ(end.inverted, 0);
  // At rest, too: by discrete detection alone 24 pairs of triangles cross there.
  play.run_frames(20);
  EXPECT_FALSE(crosses_itself(play));
}

/// Shortest paths alone keep it in itself for ever: what lies above the middle of the other part leaves upwards.
TEST(SceneRuns, ANoodleThatRunsRightThroughItselfIsFreeWithinThreeFrames) {
  Play play(load("tangled_noodle", {{"/bodies/0/mesh/length", "2.9"},
                                    {"/bodies/0/poses/1/crossings", "1"},
                                    {"/bodies/0/poses/0/matrix", "[[1, 0, 0], [0, 1, 0], [0.02, 0, 1]]"}}));
  EXPECT_GT(tangle_of(play).vertices, 40);
  play.run_frames(3);
  EXPECT_FALSE(crosses_itself(play));
  EXPECT_EQ(tangle_of(play).inverted, 0);
}

/// Pressed together while it passes through itself (SPB figure 16); then contacts by DCD have eight frames. After 30
/// steps two thirds of the vertices are free: a regression mark.
TEST(SceneRuns, ATangledBallIsFreeWithinEightFrames) {
  Play play(load("tangled_ball", {{"/bodies/0/mesh/elements", "13500"}}));
  play.run_frames(24);
  EXPECT_EQ(play.contacts(), 0);
  const Tangle start = tangle_of(play);
  EXPECT_GT(start.vertices, 100);
  EXPECT_GT(start.deepest, 0.1);
  play.step(30);
  EXPECT_LT(tangle_of(play).vertices, start.vertices / 3);
  play.step(370);
  const Tangle end = tangle_of(play);
  EXPECT_EQ(end.vertices, 0);
  EXPECT_EQ(end.inverted, 0);
}

/// The same by the hybrid, which users have by default: a gate that lets no element of a fold be inverted keeps it.
TEST(SceneRuns, ATangledBallComesFreeByTheHybrid) {
  Play play(load(
      "tangled_ball",
      {{"/bodies/0/mesh/elements", "13500"}, {"/contact/mode", "\"hybrid\""}, {"/contact/interior_points", "false"}}));
  play.run_frames(24);
  EXPECT_GT(tangle_of(play).vertices, 100);
  play.run_frames(12);
  const Tangle end = tangle_of(play);
  EXPECT_EQ(end.vertices, 0);
  EXPECT_EQ(end.inverted, 0);
  EXPECT_FALSE(crosses_itself(play));
}

/// In steps in which it flies past a whole edge it would be held back all at once, and stop dead.
TEST(SceneRuns, ABallThatIsThrownDownSpringsBack) {
  const std::string text = R"({"selvage_scene": 1, "bodies": [
    {"mesh": {"shape": "ball", "radius": 0.25, "cell": 0.07}, "translate": [0, 0, 1.5], "velocity": [0, 0, -20],
     "material": {"youngs_modulus": 1e6, "poisson_ratio": 0.4, "density": 1000}}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}])";
  Play play(parse_scene(text + "}", "scene.json"));
  const double edge = mean_edge_of(play.scene().model, play.scene().model.bodies[0]);
  EXPECT_EQ(play.scene().substeps, std::ceil(20.0 / 60 / (0.5 * edge)));
  EXPECT_EQ(parse_scene(text + R"(, "max_speed": 1})", "scene.json").substeps, 5);
  EXPECT_EQ(parse_scene(text + R"(, "solver": "vbd"})", "scene.json").substeps, 5);
  EXPECT_EQ(parse_scene(text + R"(, "frames_per_second": 240})", "scene.json").substeps, 5);
  play.run_frames(4);
  const double low = play.middle_of(0)[2];
  play.run_frames(8);
  EXPECT_GT(play.middle_of(0)[2], low + 0.5);  // at 5 m/s or more
}

}  // namespace
}  // namespace selvage
