// A sheet in a funnel, in steps three times as long as those of the scene: in one of 336 it is led too far to have
// room. Compilers whose last digits differ may have no such step.
#include "scene/guarded_steps.h"
#include "selvage/scene/run.h"
#include "selvage/self_collision/continuous_collision.h"
#include "temporary_folder.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

namespace selvage {
namespace {

using test::TemporaryFolder;

constexpr int kFrames = 112;

Scene funnel_in_long_steps() {
  return read_scene(std::filesystem::path(SELVAGE_SCENES) / "cloth_funnel.json", "small",
                    std::array<std::string, 1>{"/substeps=3"});
}

TEST(GuardedSteps, HalvesAStepThatCannotBeGuaranteedAndNothingMeetsInItsParts) {
  const Scene scene = funnel_in_long_steps();
  const TriangleMesh surface = surface_of(scene.model);
  State state = scene.initial_state, whole = scene.initial_state;
  GuardedSteps steps(scene, true);
  SceneSolver solver(scene, true);
  std::int64_t halved = 0;
  for (int step = 0; halved == 0 && step < kFrames * scene.substeps; ++step) {
    int parts = 0;
    std::vector<Vec3> last = state.positions;
    halved = steps.step(state, [&](const SceneSolver&) {
      ++parts;
      EXPECT_TRUE(ContinuousCollisionFinder(surface, last, state.positions).find_pairs().empty()) << step;
      last = state.positions;
    });
    EXPECT_EQ(parts, halved + 1);
    EXPECT_EQ(state.steps, step + 1);
    EXPECT_EQ(state.time, (step + 1) * scene.options.time_step);
    if (halved > 0) {
      EXPECT_THROW(solver.step(whole), PinchError);
    } else {
      solver.step(whole);
      ASSERT_EQ(state.positions, whole.positions) << step;
      ASSERT_EQ(state.velocities, whole.velocities) << step;
    }
  }
  if (halved == 0) GTEST_SKIP() << "last digits of this build leave room in every step";
}

TEST(GuardedSteps, EndInTheSameBitsForAnyNumberOfThreadsAndAfterAStop) {
  const Scene scene = funnel_in_long_steps();
  const auto run = [&](const TemporaryFolder& folder, std::int64_t frames, int threads, bool is_resumed) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    RunOptions options;
    options.folder = folder.path();
    options.frames = frames;
    options.resume = is_resumed;
    return run_scene(scene, options);
  };
  const TemporaryFolder whole, stopped;
  const RunReport report = run(whole, kFrames, 1, false);
  ASSERT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  std::int64_t halved = 0;
  for (const FrameStatistics& row : report.frames) {
    halved += row.halved_steps;
    EXPECT_EQ(row.triangle_pairs, 0);
    EXPECT_EQ(row.impacts_left, 0);
  }
  run(stopped, kFrames - 3, 2, false);
  EXPECT_EQ(run(stopped, kFrames, 2, true).fingerprint, report.fingerprint);
  if (halved == 0) GTEST_SKIP() << "last digits of this build leave room in every step";
}

}  // namespace
}  // namespace selvage
