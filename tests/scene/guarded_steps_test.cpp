// A box that a handle leads around by 120 degrees in one step. The straight way there goes through a box that is
// pinned; the ways of two steps of 60 degrees go around it.
#include "scene/guarded_steps.h"
#include "scene/stopped_run.h"
#include "selvage/scene/run.h"
#include "selvage/self_collision/continuous_collision.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

Scene led_around() {
  return parse_scene(R"({"selvage_scene": 1, "frames": 2, "frames_per_second": 10, "substeps": 1,
    "gravity": [0, 0, 0], "contact": {"guarantee": true}, "bodies": [
      {"mesh": {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1}, "translate": [0.9, -0.1, 0],
       "handles": [{"region": {"box": {"min": [-9, -9, -9], "max": [9, 9, 9]}},
                    "motion": {"axis": [0, 0, 1], "centre": [0, 0, 0],
                               "keyframes": [{"time": 0.1}, {"time": 0.2, "degrees": 120}]}}]},
      {"mesh": {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1}, "translate": [0.15, 0.333, 0.01],
       "pinned": [{"box": {"min": [-9, -9, -9], "max": [9, 9, 9]}}]}]})",
                     "around.json");
}

TEST(GuardedSteps, HalveAStepThatCannotBeGuaranteedAndNothingMeetsInItsParts) {
  const Scene scene = led_around();
  const TriangleMesh surface = surface_of(scene.model);
  State state = scene.initial_state, whole = scene.initial_state;
  GuardedSteps steps(scene, true);
  SceneSolver solver(scene, true);
  std::array<int, 2> parts{}, halved{};
  for (int step = 0; step < 2; ++step) {
    std::vector<Vec3> last = state.positions;
    halved[step] = static_cast<int>(steps.step(state, 0, [&](const SceneSolver&) {
      ++parts[step];
      EXPECT_TRUE(ContinuousCollisionFinder(surface, last, state.positions).find_pairs().empty()) << step;
      last = state.positions;
    }));
    EXPECT_EQ(state.steps, step + 1);
    EXPECT_EQ(state.time, (step + 1) * scene.options.time_step);
    if (step == 0) {
      solver.step(whole);
      EXPECT_EQ(state.positions, whole.positions);
      EXPECT_EQ(state.velocities, whole.velocities);
    }
  }
  EXPECT_EQ(halved, (std::array{0, 1}));
  EXPECT_EQ(parts, (std::array{1, 2}));
  EXPECT_THROW(solver.step(whole), PinchError);
}

TEST(GuardedSteps, AreCountedAndEndInTheSameBitsForAnyNumberOfThreadsAndAfterAStop) {
  const Scene scene = led_around();
  const RunReport report = test::run_with_and_without_stop(scene, 2, 1);
  ASSERT_EQ(report.frames.size(), 3U);
  EXPECT_EQ(report.frames[1].halved_steps, 0);
  EXPECT_EQ(report.frames[2].halved_steps, 1);
}

}  // namespace
}  // namespace selvage
