// When steps that the program chooses are halved.
#include "scene/default_substeps.h"
#include "scene/stopped_run.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// A second, and a quarter.
constexpr int kFrames = 60, kQuarter = 15;

/// Two boxes of 48 elements with other values of the scene.
Scene boxes(const std::string& values = "") {
  return parse_scene(R"({"selvage_scene": 1, )" + values + R"("bodies": [
      {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}},
      {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [3, 0, 0]}]})",
                     "boxes.json");
}

/// The first box with its inner vertex almost on a corner: some of its elements are thin, its volume is as before.
State pressed(const Scene& scene) {
  State state = scene.initial_state;
  for (Index v = 0; v < scene.model.bodies[0].vertex_count; ++v)
    if (state.positions[v].isApprox(Vec3(0.5, 0.5, 0.5))) state.positions[v] = {0.02, 0.02, 0.02};
  return state;
}

/// Rows of frames whose steps were halved so often, each with something held back.
std::vector<FrameStatistics> rows_of(const Scene& scene, int frames, int halvings, std::int64_t held_back = 1) {
  FrameStatistics row;
  row.halved_steps = scene.substeps * ((std::int64_t{1} << halvings) - 1);
  row.held_back_vertices = held_back;
  return std::vector<FrameStatistics>(frames, row);
}

TEST(DefaultHalvings, RiseWhileThinElementsAreHeldBack) {
  const Scene scene = boxes();
  ASSERT_EQ(scene.substeps, 5);
  const State state = pressed(scene);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kQuarter, 0)), 1);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kFrames, 1)), 2);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, 90, 2)), 2);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kQuarter - 1, 0)), 0);  // too soon
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kFrames - 1, 1)), 1);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, 90, 1, 0)), 1);
  EXPECT_EQ(default_halvings(scene, scene.initial_state, rows_of(scene, kQuarter, 0)), 0);
  std::vector<FrameStatistics> rows = rows_of(scene, 30, 0);
  rows[20].held_back_vertices = 0;
  EXPECT_EQ(default_halvings(scene, state, rows), 0);
}

TEST(DefaultHalvings, FallASecondAfterNothingIsThinAndOnlyOnce) {
  const Scene scene = boxes();
  const State& state = scene.initial_state;
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kFrames, 2)), 0);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kFrames, 1)), 0);
  EXPECT_EQ(default_halvings(scene, state, rows_of(scene, kFrames - 1, 2)), 2);
  std::vector<FrameStatistics> rows = rows_of(scene, kFrames, 1);
  rows.front().halved_steps = 0;
  EXPECT_EQ(default_halvings(scene, state, rows), 1);
  rows = rows_of(scene, 100, 1);
  rows[0] = rows[20] = rows_of(scene, 1, 0)[0];
  EXPECT_EQ(default_halvings(scene, state, rows), 1);  // it has fallen before
  rows[20] = rows[21];
  EXPECT_EQ(default_halvings(scene, state, rows), 0);
}

TEST(DefaultHalvings, AreForStepsThatTheProgramChooses) {
  for (const char* values : {R"("substeps": 5, )", R"("solver": "newton", )", R"("solver": "vbd", )"}) {
    const Scene scene = boxes(values);
    EXPECT_EQ(default_halvings(scene, pressed(scene), rows_of(scene, kQuarter, 0)), 0) << values;
  }
}

TEST(DefaultHalvings, GiveAtMost30StepsAFrame) {
  Scene scene = boxes();
  const State state = pressed(scene);
  for (const auto& [substeps, halvings] : {std::pair{7, 2}, {8, 1}, {15, 1}, {16, 0}, {50, 0}}) {
    scene.substeps = substeps;
    int now = 0;
    for (int frame = 0; frame < 5; ++frame) now = default_halvings(scene, state, rows_of(scene, kFrames, now));
    EXPECT_EQ(now, halvings) << substeps;
  }
}

TEST(DefaultHalvings, DoNotRiseWhereBodiesAreInOneAnotherOrAsleepAndAreNoneWhereOneIsCrushed) {
  const Scene scene = boxes();
  const State state = pressed(scene);
  for (const auto counted : {&FrameStatistics::penetrating_vertices, &FrameStatistics::penetrating_edges,
                             &FrameStatistics::triangle_pairs, &FrameStatistics::vertices_in_colliders}) {
    std::vector<FrameStatistics> rows = rows_of(scene, kFrames, 1);
    rows.back().*counted = 1;
    EXPECT_EQ(default_halvings(scene, state, rows), 1);
  }
  State crushed = state;
  for (Index v = scene.model.bodies[1].first_vertex; v < scene.model.mesh.vertex_count(); ++v)
    crushed.positions[v][2] *= 0.4;
  EXPECT_EQ(default_halvings(scene, crushed, rows_of(scene, kFrames, 1)), 0);
  State asleep = state;
  asleep.rest_times = {1, 0};
  EXPECT_EQ(default_halvings(scene, asleep, rows_of(scene, kQuarter, 0)), 0);
  asleep.rest_times = {0, 1};
  EXPECT_EQ(default_halvings(scene, asleep, rows_of(scene, kQuarter, 0)), 1);
}

/// A handle presses the middle of a box almost onto the floor.
TEST(DefaultHalvings, EndInTheSameBitsForAnyNumberOfThreadsAndAfterAStop) {
  const Scene scene = parse_scene(R"({"selvage_scene": 1, "bodies": [
      {"mesh": {"shape": "box", "size": [0.5, 0.5, 0.5], "cell": 0.1}, "translate": [0, 0, 0.01],
       "handles": [{"region": {"box": {"min": [0.15, 0.15, 0.45], "max": [0.35, 0.35, 0.55]}},
                    "motion": {"keyframes": [{"time": 0}, {"time": 0.1, "translate": [0, 0, -0.42]}]}}]}],
      "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})",
                                  "pressed.json");
  const RunReport report = test::run_with_and_without_stop(scene, 27, 24);
  ASSERT_EQ(report.frames.size(), 28U);
  EXPECT_EQ(report.frames[12].halved_steps, 0);
  EXPECT_EQ(report.frames[27].halved_steps, scene.substeps);
  EXPECT_EQ(report.frames[27].steps, 27 * scene.substeps);
}

}  // namespace
}  // namespace selvage
