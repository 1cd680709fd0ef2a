// Guaranteed runs, judged by what they store: every frame by exact detection, every step by exact continuous detection.
#include "scene/scene_solver.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"
#include "selvage/self_collision/continuous_collision.h"
#include "temporary_folder.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using test::read_text;
using test::TemporaryFolder;

/// Light below heavy, thrown into a box.
const std::string kHeap = R"({"selvage_scene": 1, "solver": "xpbd", "substeps": 5, "contact": {"guarantee": true},
  "bodies": [
    {"mesh": {"shape": "torus", "radius": 0.4, "inner_radius": 0.12, "elements": 400}, "velocity": [0, 0, -3],
     "instances": {"list": [{"translate": [0, 0, 0.3]}, {"translate": [0.3, 0.1, 0.65]}]},
     "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4, "density": 200}},
    {"mesh": {"shape": "box", "size": [0.5, 0.5, 0.5], "cell": 0.25}, "velocity": [0, 0, -3],
     "instances": {"list": [{"translate": [-0.4, -0.3, 0.95]}, {"translate": [0.15, -0.1, 1]}],
                   "jitter": {"degrees": 20, "seed": 2}},
     "material": {"youngs_modulus": 5e5, "poisson_ratio": 0.4, "density": 1500}}],
  "colliders": [{"box": {"min": [-0.9, -0.9, 0], "max": [0.9, 0.9, 5]}}]})";

/// Soft cubes that fall on one another and slide off.
const std::string kCubes = R"({"selvage_scene": 1, "solver": "vbd", "substeps": 1, "iterations": 3,
  "contact": {"guarantee": true},
  "bodies": [
    {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.34}, "velocity": [0, 0, -12],
     "instances": {"list": [{"translate": [0, 0, 0.2]}, {"translate": [0.31, 0.17, 1.4]}, {"translate": [0.7, 0.34, 2.6]}]},
     "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4}}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})";

std::int64_t pairs_on_way(const TriangleMesh& surface, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  SelfCollisionOptions options;
  options.method = CullingMethod::kBvh;
  const ContinuousPairs pairs = ContinuousCollisionFinder(surface, from, to, options).find_pairs();
  return std::ssize(pairs.vertex_face) + std::ssize(pairs.edge_edge);
}

/// Nothing meets in any of 300 frames, nor in a step on the way.
void expect_free(const std::string& text) {
  const Scene scene = parse_scene(text, "scene.json");
  const TriangleMesh surface = boundary_surface(scene.model.mesh);
  const std::int64_t frames = test::scaled(300, 10);
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  options.frames = frames;
  const RunReport report = run_scene(scene, options);
  ASSERT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  EXPECT_EQ(guaranteed_from(report.frames), 0);

  State state = scene.initial_state;
  SceneSolver solver(scene, true);
  SelfCollisionFinder finder(surface, state.positions);
  std::int64_t met = 0;
  for (std::int64_t frame = 0; frame <= frames; ++frame) {
    for (int step = 0; step < (frame > 0 ? scene.substeps : 0); ++step) {
      const std::vector<Vec3> before = state.positions;
      solver.step(state);
      ASSERT_EQ(pairs_on_way(surface, before, state.positions), 0) << frame;
      met += solver.statistics().impacts_met;
      if (solver.statistics().hold_back_rounds == 0) {
        EXPECT_EQ(solver.statistics().held_back_vertices, 0);
      }
    }
    const std::vector<Vec3> stored = read_frame(frame_path(folder.path(), frame)).positions;
    ASSERT_EQ(stored, state.positions) << "frames hold every bit";
    finder.update(stored);
    ASSERT_TRUE(finder.find_pairs().empty()) << frame;
  }
  EXPECT_GE(met, test::scaled(1, 0));
}

TEST(GuaranteedRun, OfAHeapIsFreeInEveryFrameAndStep) {
  expect_free(kHeap);
}

TEST(GuaranteedRun, OfSoftCubesByVbdIsFreeInEveryFrameAndStep) {
  expect_free(kCubes);
}

TEST(GuaranteedRun, EndsAlikeWhereverItWasInterrupted) {
  const Scene scene = parse_scene(kHeap, "heap.json");
  const TemporaryFolder whole, parts;
  RunOptions options;
  options.folder = whole.path();
  options.frames = 20;
  const RunReport expected = run_scene(scene, options);
  options.folder = parts.path();
  for (const int last : {3, 12, 20}) {
    options.frames = last;
    options.resume = last > 3;
    const RunReport report = run_scene(scene, options);
    if (last == 20) {
      EXPECT_EQ(report.fingerprint, expected.fingerprint);
    }
  }
  for (std::int64_t frame = 0; frame <= 20; ++frame)
    EXPECT_EQ(read_text(frame_path(whole.path(), frame)), read_text(frame_path(parts.path(), frame))) << frame;
}

TEST(GuaranteedRun, SaysSinceWhenItHolds) {
  const Scene scene = parse_scene(R"({"selvage_scene": 1, "gravity": [0, 0, 0], "contact": {"guarantee": true},
    "bodies": [{"mesh": {"shape": "box", "size": [0.4, 0.4, 0.4], "cell": 0.1}},
               {"mesh": {"shape": "box", "size": [0.4, 0.4, 0.4], "cell": 0.1}, "translate": [0.05, 0.03, 0.33]}]})",
                                  "tangled.json");
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  options.frames = 40;
  const RunReport report = run_scene(scene, options);
  const auto from = guaranteed_from(report.frames);
  ASSERT_TRUE(from);
  EXPECT_GT(*from, 0);
  EXPECT_GT(report.frames[static_cast<std::size_t>(*from)].unguarded_vertices, 0);
  for (std::int64_t frame = *from; frame <= 40; ++frame)
    EXPECT_EQ(report.frames[static_cast<std::size_t>(frame)].triangle_pairs, 0) << frame;
  EXPECT_NE(read_text(folder.path() / "summary.json").find("\"from_frame\": " + std::to_string(*from)),
            std::string::npos);
  EXPECT_EQ(guaranteed_from(std::span(report.frames).first(2)), std::nullopt);
}

/// Two boxes, one above the other, that pins or a motion hold.
std::string held_boxes(const std::string& height, const std::string& motion) {
  return R"({"selvage_scene": 1, "contact": {"guarantee": true}, "bodies": [
    {"mesh": {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1}, "pinned": [{"box": {"min": [-1, -1, -1], "max": [1, 1, 1]}}]},
    {"mesh": {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1}, "translate": [0.02, 0.01, )" +
         height + R"(], "handles": [{"region": {"box": {"min": [-1, -1, -1], "max": [1, 1, 1]}}, "motion": )" + motion +
         "}]}]}";
}

TEST(GuaranteedRun, StopsWhereHandlesLeaveNoRoomAndNamesFrameAndPlace) {
  const Scene scene = parse_scene(
      held_boxes("0.3", R"({"keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, -0.3]}]})"), "pinch.json");
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  const RunReport report = run_scene(scene, options);
  EXPECT_EQ(report.outcome, RunOutcome::kPinched);
  EXPECT_TRUE(report.message.starts_with("frame ")) << report.message;
  EXPECT_NE(report.message.find("near ["), std::string::npos) << report.message;
  EXPECT_GT(report.frames.back().frame, 5);
  EXPECT_EQ(report.frames.back().triangle_pairs, 0);
  EXPECT_NE(read_text(folder.path() / "summary.json").find("\"outcome\": \"pinched\""), std::string::npos);
}

std::string error_of(const std::string& text) {
  try {
    parse_scene(text, "s.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(GuaranteedRun, IsRefusedWhereItCannotBe) {
  const std::string pinned = error_of(held_boxes("0.1", R"({"keyframes": [{"time": 0}]})"));
  EXPECT_EQ(pinned.substr(0, 69), "s.json: contact.guarantee: bodies 'body0' and 'body1' start in one an") << pinned;
  EXPECT_EQ(error_of(held_boxes("0.1", R"({"keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, 1]}]})")), "");
  EXPECT_EQ(error_of(held_boxes("0.3", R"({"keyframes": [{"time": 0}]})")), "");
  for (const std::string other : {R"("mode": "ccd")", R"("hold_back": false)", R"("edges": false)",
                                  R"("from_frame": 3)", R"("interior_points": true)"}) {
    std::string text = kCubes;
    text.insert(text.find("\"guarantee\""), other + ", ");
    EXPECT_EQ(error_of(text).substr(0, 32), "s.json: contact.guarantee: needs") << error_of(text);
  }
}

}  // namespace
}  // namespace selvage
