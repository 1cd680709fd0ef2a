// A solver that is kept from step to step, which reuses what it knows, and one that knows nothing: in all scenes the
// same bits.
#include "scene/scene_solver.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>

namespace selvage {
namespace {

namespace fs = std::filesystem;

/// A scene at a small size, until bodies have been in contact for a while.
struct KeptRun {
  std::string scene;
  int frames;
  std::vector<std::string> changes;
  SolverKind solver = SolverKind::kXpbd;  ///< in place of the scene's, if another one
};

const std::vector<std::string> kTwoOctopi{"/bodies/0/instances/grid/counts=[1, 1, 2]",
                                          "/bodies/0/instances/grid/spacing=[4.1, 4.1, 1.2]",
                                          "/bodies/0/instances/jitter/degrees=8", "/bodies/0/translate=[-2.1, 0, 1.2]"};

/// Each file of the folder of scenes has a row.
const std::vector<KeptRun> kRuns{
    {"balls_16",
     30,
     {"/bodies/0/mesh/tentacles=5", "/bodies/0/mesh/elements=3800", "/bodies/0/instances/grid/counts=[1, 1, 2]",
      "/bodies/0/translate=[0, 0, 0.2]"}},
    {"cloth_ball", 100, {}},
    {"cloth_ball", 60, {}, SolverKind::kVbd},
    {"cloth_funnel", 60, {}},
    {"cloth_funnel", 60, {}, SolverKind::kVbd},
    {"cloth_on_octopus", 40, {}},
    {"cloth_on_octopus", 20, {}, SolverKind::kVbd},
    {"fifty_layers", 60, {}},
    {"fifty_layers", 60, {}, SolverKind::kVbd},
    {"flattened_ball", 40, {"/bodies/0/mesh/tentacles=6", "/bodies/0/mesh/elements=3000"}},
    {"karate", 60, {}},
    {"long_noodle",
     40,
     {"/bodies/0/mesh/length=5", "/bodies/0/mesh/cell=0.06", "/colliders/0/bowl/radius=0.5",
      "/colliders/0/bowl/centre=[0, 0, 0.6]"}},
    {"nested_knot", 60, {"/bodies/0/mesh/cell=0.014", "/substeps=10"}},
    {"octopi_16",
     40,
     {"/bodies/0/instances/grid/counts=[1, 1, 2]", "/bodies/0/instances/grid/spacing=[4.2, 4.2, 1.2]",
      "/bodies/0/instances/jitter/degrees=8", "/bodies/0/translate=[2.2, 2.2, 1.2]",
      "/colliders/0/box/max=[4.4, 4.4, 100]"}},
    {"octopi_6_implicit",
     30,
     {R"(/bodies/0/mesh={"shape": "ball", "radius": 0.6, "cell": 0.2})", "/bodies/0/translate=[0, 0, 0.7]",
      "/bodies/0/instances/grid/counts=[1, 1, 2]", "/bodies/0/instances/grid/spacing=[4.1, 4.1, 1.3]"},
     SolverKind::kNewton},
    {"octopi_8_ccd", 60, kTwoOctopi},
    {"octopi_8_dcd", 60, kTwoOctopi},
    {"octopi_8_hybrid", 60, kTwoOctopi},
    {"sliding_cube", 40, {}},
    {"t_shirt_box", 60, {}},
    {"tangled_ball", 30, {"/bodies/0/mesh/elements=13500"}},
    {"tangled_noodle", 30, {"/bodies/0/mesh/length=3", "/bodies/0/poses/1/crossings=1"}},
    {"twist_cloth", 100, {}},
    {"twist_cloth", 100, {}, SolverKind::kVbd},
    {"twisted_beam", 60, {"/bodies/0/mesh/cell=0.06"}},
    {"twisted_rods", 60, {"/bodies/0/mesh/cell=0.06"}},
    {"two_balls", 8, {"/bodies/0/mesh/tentacles=6", "/bodies/0/mesh/elements=4600"}},
    {"first/funnel", 60, {}},
    {"first/gears", 30, {"/bodies/0/mesh/length=0.05", "/bodies/1/mesh/length=0.05"}},
    {"first/grip", 60, {"/bodies/0/mesh/cell=0.1", "/bodies/1/mesh/cell=0.1", "/bodies/2/mesh/cell=0.1"}},
    {"first/heap", 100, {"/bodies/0/mesh/cell=0.2", "/bodies/1/mesh/elements=300"}},
    {"first/knotted_rope", 100, {"/bodies/0/mesh/cell=0.03"}},
    {"first/net", 50, {"/bodies/0/mesh/cell=0.06", "/bodies/1/mesh/cell=0.06"}},
    {"first/pile", 60, {}},
    {"first/slope", 100, {"/bodies/0/mesh/cell=0.2"}},
    {"first/squeeze",
     60,
     {R"(/bodies/0/mesh={"shape": "ball", "radius": 0.3, "cell": 0.1})", "/bodies/0/translate=[0, 0, 0.1]"}},
    {"first/stack", 60, {"/bodies/0/mesh/cell=0.17"}},
};

void PrintTo(const KeptRun& run, std::ostream* out) {
  *out << run.scene;
}

std::string kept_run_name(const testing::TestParamInfo<KeptRun>& run) {
  std::string name = run.param.scene + (run.param.solver == SolverKind::kVbd ? "_by_vbd" : "");
  std::ranges::replace(name, '/', '_');
  return name;
}

TEST(KeptSolvers, AreTestedInAllScenesThatThereAre) {
  const fs::path folder(SELVAGE_SCENES);
  std::set<std::string> there, tested;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".json")
      there.insert(entry.path().lexically_relative(folder).replace_extension().generic_string());
  for (const KeptRun& run : kRuns) tested.insert(run.scene);
  EXPECT_EQ(there, tested);
}

class KeptSolverIn : public testing::TestWithParam<KeptRun> {};

/// The last step of every fifth frame is done by a fresh solver, too.
TEST_P(KeptSolverIn, TakesStepsToTheBitsThatAFreshOneTakesThemTo) {
  const KeptRun& run = GetParam();
  const char* scale = run.scene.starts_with("first/") ? "" : "small";
  Scene scene = read_scene(fs::path(SELVAGE_SCENES) / (run.scene + ".json"), scale, run.changes);
  if (run.solver == SolverKind::kVbd) scene.solver = run.solver;
  ASSERT_EQ(scene.solver, run.solver);
  State state = scene.initial_state;
  std::optional<SceneSolver> kept;
  std::int64_t contacts = 0;
  for (int frame = 1; frame <= run.frames; ++frame) {
    const bool with_contact = frame > scene.contact_from_frame;
    if (frame == 1 || frame == scene.contact_from_frame + 1) kept.emplace(scene, with_contact);
    for (int step = 1; step <= scene.substeps; ++step) {
      State alone = state;
      kept->step(state);
      contacts += kept->statistics().collider_contacts;
      for (const std::int64_t found : kept->statistics().contact.contacts) contacts += found;
      if (step < scene.substeps || frame % 5 != 0) continue;
      SceneSolver(scene, with_contact).step(alone);
      ASSERT_EQ(alone.positions, state.positions) << "frame " << frame;
      ASSERT_EQ(alone.velocities, state.velocities) << "frame " << frame;
    }
  }
  EXPECT_GT(contacts, 0) << "bodies are to meet, in " << run.frames << " frames";
}

INSTANTIATE_TEST_SUITE_P(All, KeptSolverIn, testing::ValuesIn(kRuns), kept_run_name);

}  // namespace
}  // namespace selvage
