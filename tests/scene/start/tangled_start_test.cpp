// Bodies that start wound into themselves are brought out before the first step.
#include "scene/start/tangled_start.h"

#include "scene/stopped_run.h"
#include "simulation/crossings/body_crossings.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

/// A rod that runs through itself, beside a box; the shorter, the larger is the part of its boundary that is inside.
Scene crossed_rod(double length, const std::string& values = "", const std::string& of_rod = "") {
  return parse_scene(R"({"selvage_scene": 1, "gravity": [0, 0, 0], )" + values + R"("bodies": [
      {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.5}, "translate": [0, 0, 5]},
      {"mesh": {"shape": "rod", "length": )" +
                         std::to_string(length) + R"(, "radius": 0.25, "elements": 400}, "velocity": [0, 1, 0],)" +
                         of_rod + R"("poses": [{"pose": "self-crossing", "crossings": 1}]}]})",
                     "crossed.json");
}

BodyCrossings measure(const Scene& scene, const State& state) {
  const BoundaryPathFinder<3> finder(scene.model.mesh, state.positions);
  return BodyCrossingFinder(scene.model, state.positions).measure(finder, state.positions);
}

Index resolve(const Scene& scene, State& state) {
  return resolve_tangled_start(scene, measure(scene, state), state, {});
}

RunReport run(const Scene& scene, std::int64_t frames) {
  const test::TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  options.frames = frames;
  return run_scene(scene, options);
}

TEST(TangledStart, IsBroughtOutBeforeTheFirstFrameInTheSameBitsAfterAStop) {
  const RunReport report = test::run_with_and_without_stop(crossed_rod(6), 2, 0);
  EXPECT_GT(report.frames[0].penetrating_vertices, 0);
  EXPECT_EQ(report.frames[0].resolved_bodies, 0);
  EXPECT_EQ(report.frames[1].resolved_bodies, 1);
  EXPECT_EQ(report.frames[2].resolved_bodies, 0);
  for (const std::size_t frame : {1, 2}) {
    EXPECT_EQ(report.frames[frame].path_queries, 0);
    EXPECT_EQ(report.frames[frame].triangle_pairs, 0);
  }
}

TEST(TangledStart, LeavesWhatOthersAskForToContacts) {
  for (const char* values :
       {R"("start_tangled": "simulate", )", R"("contact": {"mode": "none"}, )", R"("contact": {"from_frame": 1}, )"})
    EXPECT_EQ(run(crossed_rod(6, values), 1).frames[1].resolved_bodies, 0) << values;
  EXPECT_EQ(run(crossed_rod(6, R"("start_tangled": "resolve", )"), 1).frames[1].resolved_bodies, 1);
}

TEST(TangledStart, LeavesBodiesOfWhichLittleIsInsideToContacts) {
  const Scene scene = crossed_rod(12);
  State state = scene.initial_state;
  EXPECT_GT(measure(scene, state).total.vertices, 0);
  EXPECT_EQ(resolve(scene, state), 0);
  EXPECT_EQ(state.positions, scene.initial_state.positions);
}

TEST(TangledStart, MovesTheTangledBodyAloneAndNoVelocity) {
  const Scene scene = crossed_rod(6);
  State state = scene.initial_state;
  EXPECT_EQ(resolve(scene, state), 1);
  EXPECT_TRUE(measure(scene, state).pairs.empty());
  EXPECT_EQ(state.velocities, scene.initial_state.velocities);
  const auto rod = scene.model.bodies[1].first_vertex;
  const auto &before = scene.initial_state.positions, &after = state.positions;
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + rod, after.begin()));
  EXPECT_FALSE(std::equal(before.begin() + rod, before.end(), after.begin() + rod));
}

TEST(TangledStart, LeavesPinnedVerticesAndThoseOfHandlesInTheirPlaces) {
  const std::string end = R"({"box": {"min": [-9, -9, -9], "max": [0.5, 9, 9]}})";
  for (const auto& [held, values] :
       {std::pair{true, R"("pinned": [)" + end + "],"},
        {true, R"("handles": [{"region": )" + end + R"(, "motion": {"keyframes": [{"time": 0}]}}],)"},
        {false, R"("handles": [{"region": )" + end + R"(, "motion": {"keyframes": [{"time": 0}]}, "release": 0}],)"}}) {
    const Scene scene = crossed_rod(6, "", values);
    State state = scene.initial_state;
    EXPECT_EQ(resolve(scene, state), 1) << values;
    bool has_moved = false;
    for (Index v = scene.model.bodies[1].first_vertex; v < scene.model.mesh.vertex_count(); ++v)
      if (scene.model.rest_positions[v][0] <= 0.5) has_moved |= state.positions[v] != scene.initial_state.positions[v];
    EXPECT_NE(has_moved, held) << values;
  }
}

TEST(TangledStart, LeavesVerticesWithoutMassInTheirPlaces) {
  Scene scene = crossed_rod(6);
  std::fill(scene.model.inverse_masses.begin(), scene.model.inverse_masses.end(), 0);
  State state = scene.initial_state;
  EXPECT_EQ(resolve(scene, state), 0);
  EXPECT_EQ(state.positions, scene.initial_state.positions);
}

TEST(TangledStart, StaysWhereItCannotBeResolved) {
  const Scene scene = crossed_rod(6, "", R"("pinned": [{"box": {"min": [-9, -9, -9], "max": [9, 9, 9]}}],)");
  State state = scene.initial_state;
  EXPECT_EQ(resolve(scene, state), 0);
  EXPECT_EQ(state.positions, scene.initial_state.positions);
}

/// The shape at the start cannot be one without stress then.
TEST(TangledStart, IsBroughtOutTowardsItsRestWithInvertedElements) {
  const Scene scene = crossed_rod(6);
  State state = scene.initial_state;
  const auto& element = scene.model.mesh.elements()[scene.model.bodies[1].first_element];
  const Vec3 middle = (state.positions[element[1]] + state.positions[element[2]] + state.positions[element[3]]) / 3;
  state.positions[element[0]] += 1.5 * (middle - state.positions[element[0]]);
  EXPECT_EQ(resolve(scene, state), 1);
  EXPECT_TRUE(measure(scene, state).pairs.empty());
}

}  // namespace
}  // namespace selvage
