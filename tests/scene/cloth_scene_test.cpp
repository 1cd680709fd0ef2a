// Scenes with cloth: what is read, what is refused, and what a run stores.
#include "scene/frame_measures.h"
#include "scene/guarded_steps.h"
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

using test::TemporaryFolder;

std::string text_of_cloth(const std::string& body, const std::string& more = "") {
  return R"({"selvage_scene": 1, "bodies": [{"name": "sheet", )" + body + "}]" + more + "}";
}

std::string text_of_sheet(const std::string& material) {
  return text_of_cloth(R"("mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.25}, "material": )" + material);
}

std::string cloth_refusal(const std::string& text) {
  try {
    parse_scene(text, "scene.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ClothScene, IsReadWithItsMaterial) {
  const Scene usual =
      parse_scene(text_of_cloth(R"("mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.25})"), "s.json");
  EXPECT_EQ(usual.substeps, 10);
  const Body& body = usual.model.bodies.at(0);
  EXPECT_EQ(body.triangle_count, 32);
  EXPECT_EQ(body.cloth.kind, ClothKind::kIsotropic);
  EXPECT_EQ(body.cloth.thickness, 1e-3);
  EXPECT_EQ(body.cloth.damping, 0.002);
  const Scene woven = parse_scene(text_of_cloth(R"("mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.005},
                  "rotate": {"axis": [0, 0, 1], "degrees": 90},
                  "material": {"kind": "cloth", "warp": 5, "weft": 4, "shear": 3, "bending": 0, "density": 0.3})"),
                                  "s.json");
  const ClothMaterial& cloth = woven.model.bodies.at(0).cloth;
  EXPECT_EQ(cloth.kind, ClothKind::kWoven);
  EXPECT_EQ(cloth.weft, 4);
  EXPECT_NEAR((cloth.warp_direction - Vec3(0, 1, 0)).norm(), 0, 1e-15);
  EXPECT_NEAR(cloth.thickness, 5e-4, 1e-12);
}

TEST(ClothScene, RefusesWhatCannotBe) {
  const auto expect = [](const std::string& text, const std::string& what) {
    EXPECT_NE(cloth_refusal(text).find(what), std::string::npos) << cloth_refusal(text);
    EXPECT_EQ(cloth_refusal(text).find('\n'), std::string::npos);
  };
  expect(text_of_sheet(R"({"kind": "neo-hookean"})"),
         "bodies[0].mesh: is a surface; give its body a material of the kind");
  expect(text_of_cloth(R"("mesh": {"shape": "box"}, "material": {"kind": "cloth"})"), "is a mesh of tetrahedra");
  expect(text_of_sheet(R"({"kind": "cloth", "warp": 1, "weft": 1})"), "does not give all of warp, weft and shear");
  expect(text_of_sheet(R"({"kind": "cloth", "warp": 1, "weft": 1, "shear": 1, "stiffness": 2})"),
         "gives both a stiffness");
  expect(text_of_sheet(R"({"kind": "cloth", "thickness": 0.2})"), "more than half of its shortest edge");
  expect(text_of_sheet(R"({"kind": "cloth", "youngs_modulus": 1})"), "youngs_modulus");
  const std::string sheet = R"("mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.25})";
  expect(text_of_cloth(sheet + R"(, "scale": [1, 1e-12, 1])"), "has no area at rest");
}

/// Cloth over a soft ball on a floor, and a second sheet over both.
const std::string kPile = R"({"selvage_scene": 1, "substeps": 10, "contact": {"guarantee": true}, "bodies": [
    {"name": "ball", "mesh": {"shape": "ball", "radius": 0.2, "cell": 0.1}, "translate": [0, 0, 0.2]},
    {"name": "sheet", "mesh": {"shape": "cloth", "size": [0.8, 0.8, 0], "cell": 0.1}, "translate": [-0.4, -0.4, 0.45],
     "material": {"kind": "cloth", "bending": 1e-4},
     "instances": {"grid": {"counts": [1, 1, 2], "spacing": [0, 0, 0.06]}, "jitter": {"degrees": 5, "seed": 3}}}],
  "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})";

TEST(ClothScene, RunsAndStaysFreeAndStoresItsTriangles) {
  const Scene scene = parse_scene(kPile, "scene.json");
  const TriangleMesh surface = surface_of(scene.model);
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  options.frames = test::scaled(300, 30);
  options.vtu = true;
  options.surface = SurfaceFormat::kPly;
  const RunReport report = run_scene(scene, options);
  ASSERT_EQ(report.outcome, RunOutcome::kFinished) << report.message;
  EXPECT_EQ(guaranteed_from(report.frames), 0);
  const TopologyFile topology = read_topology(topology_path(folder.path()));
  EXPECT_EQ(topology.boundary_faces, surface_triangles(scene.model));
  std::int64_t met = 0;
  for (std::int64_t frame = 0; frame <= *options.frames; ++frame) {
    const std::vector<Vec3> positions = read_frame(frame_path(folder.path(), frame)).positions;
    ASSERT_TRUE(SelfCollisionFinder(surface, positions).find_pairs().empty()) << frame;
    EXPECT_EQ(report.frames[static_cast<std::size_t>(frame)].triangle_pairs, 0);
    met += report.frames[static_cast<std::size_t>(frame)].edge_edges;
  }
  EXPECT_GT(met, 1000);

  State state = scene.initial_state;
  SceneSolver solver(scene, true);
  for (std::int64_t step = 0; step < *options.frames * scene.substeps; ++step) {
    const std::vector<Vec3> before = state.positions;
    solver.step(state);
    ASSERT_TRUE(ContinuousCollisionFinder(surface, before, state.positions).find_pairs().empty()) << step;
  }
  EXPECT_EQ(read_frame(frame_path(folder.path(), *options.frames)).positions, state.positions);
}

struct ShippedRun {
  const char* scene;
  SolverKind solver = SolverKind::kXpbd;
  std::int64_t frames = 300;
};

/// The scenes that are shipped, at their small size: each step and each frame is judged exactly.
class ShippedClothScene : public ::testing::TestWithParam<ShippedRun> {};

TEST_P(ShippedClothScene, StaysFree) {
  const ShippedRun& run = GetParam();
  Scene scene = read_scene(std::filesystem::path(SELVAGE_SCENES) / (std::string(run.scene) + ".json"), "small");
  ASSERT_TRUE(scene.options.contact.guarantee);
  scene.solver = run.solver;
  const TriangleMesh surface = surface_of(scene.model);
  State state = scene.initial_state;
  GuardedSteps steps(scene, true);
  SelfCollisionFinder finder(surface, state.positions);
  std::int64_t contacts = 0;
  const std::int64_t frames = test::scaled(run.frames, 6);
  for (std::int64_t step = 0; step < frames * scene.substeps; ++step) {
    std::vector<Vec3> before = state.positions;
    steps.step(state, 0, [&](const SceneSolver& solver) {  // after each part, where the lid leaves room for these only
      EXPECT_TRUE(ContinuousCollisionFinder(surface, before, state.positions).find_pairs().empty()) << "step " << step;
      before = state.positions;
      EXPECT_EQ(solver.statistics().unguarded_vertices, 0);
      if (solver.statistics().impacts_met == 0 && solver.statistics().hold_back_rounds == 0) {
        EXPECT_EQ(solver.statistics().held_back_vertices, 0) << "step " << step;
      }
      for (const std::int64_t count : solver.statistics().contact.contacts) contacts += count;
      contacts += solver.statistics().collider_contacts;
    });
    ASSERT_FALSE(HasFailure());
    if ((step + 1) % scene.substeps == 0) {
      finder.update(state.positions);
      ASSERT_TRUE(finder.find_pairs().empty()) << "step " << step;
    }
  }
  if (frames >= run.frames) {
    EXPECT_GT(contacts, 1000);
  }
}

std::string name_of(const ::testing::TestParamInfo<ShippedRun>& run) {
  return run.param.scene;
}

INSTANTIATE_TEST_SUITE_P(ByXpbd, ShippedClothScene,
                         ::testing::Values(ShippedRun{"twist_cloth"}, ShippedRun{"fifty_layers"},
                                           ShippedRun{"cloth_ball"}, ShippedRun{"cloth_on_octopus"},
                                           ShippedRun{"cloth_funnel"}, ShippedRun{"t_shirt_box"}, ShippedRun{"karate"}),
                         name_of);

INSTANTIATE_TEST_SUITE_P(ByVbd, ShippedClothScene,
                         ::testing::Values(ShippedRun{"twist_cloth", SolverKind::kVbd, 160},
                                           ShippedRun{"fifty_layers", SolverKind::kVbd, 60},
                                           ShippedRun{"cloth_ball", SolverKind::kVbd, 60},
                                           ShippedRun{"cloth_on_octopus", SolverKind::kVbd, 40},
                                           ShippedRun{"cloth_funnel", SolverKind::kVbd, 60}),
                         name_of);

/// 27 kg on vertices of a gramme: what the block's friction does to the sheet must not be as much more as it is
/// lighter.
TEST(ClothScene, ABlockFallsOnASheetOnTheFloorAndThrowsNothing) {
  const Scene scene = parse_scene(R"({"selvage_scene": 1, "substeps": 10, "bodies": [
      {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.1}, "translate": [-0.5, -0.5, 0.05],
       "material": {"kind": "cloth", "thickness": 0.004}},
      {"mesh": {"shape": "box", "size": [0.3, 0.3, 0.3], "cell": 0.1}, "translate": [-0.15, -0.15, 0.35],
       "material": {"youngs_modulus": 1e5, "poisson_ratio": 0.4, "density": 1000}}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}]})",
                                  "sheet.json");
  State state = scene.initial_state;
  XpbdSolver solver(scene.model, state, scene.handles, scene.colliders, scene.options);
  double fastest = 0;
  for (int step = 0; step < 60 * scene.substeps; ++step) {
    solver.step(state);
    for (const Vec3& v : state.velocities) fastest = std::max(fastest, v.norm());
  }
  EXPECT_GT(fastest, 1);
  EXPECT_LT(fastest, 4);
  EXPECT_LT(state.positions.back()[2], 0.4);
  FrameStatistics row;
  FrameMeasures(scene).measure(state, 60, row);
  EXPECT_EQ(row.triangle_pairs, 0);
  EXPECT_EQ(row.vertices_in_colliders, 0);
}

/// A ball falls into a sheet that hangs by two sides. By 10 steps a frame the sheet is stretched by hundreds of times
/// the energy of the fall, and the ball of 3,000 kg/m3 pulls it down to the floor.
TEST(ClothScene, AHangingSheetCatchesABallWithDefaultSettings) {
  const auto hammock = [](int density) {
    return parse_scene(R"({"selvage_scene": 1, "bodies": [
      {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.1}, "translate": [-0.5, -0.5, 1],
       "pinned": [{"box": {"min": [-0.01, -0.01, -0.1], "max": [0.01, 1.01, 0.1]}},
                  {"box": {"min": [0.99, -0.01, -0.1], "max": [1.01, 1.01, 0.1]}}],
       "material": {"kind": "cloth", "thickness": 0.004}},
      {"mesh": {"shape": "ball", "radius": 0.15, "cell": 0.08}, "translate": [0, 0, 1.3],
       "material": {"youngs_modulus": 1e5, "density": )" +
                           std::to_string(density) + "}}]}",
                       "hammock.json");
  };
  EXPECT_EQ(hammock(10).substeps, 10);
  EXPECT_EQ(hammock(500).substeps, 19);
  const Scene heavy = hammock(3000);
  EXPECT_NEAR(heavy.substeps, 47, 1);
  EXPECT_EQ(heavy.options.time_step, 1.0 / (60 * heavy.substeps));
  State state = heavy.initial_state;
  XpbdSolver solver(heavy.model, state, heavy.handles, heavy.colliders, heavy.options);
  double lowest = 1;
  for (int step = 0; step < 90 * heavy.substeps; ++step) {
    solver.step(state);
    lowest = std::min(lowest, state.positions.back()[2]);
  }
  EXPECT_LT(lowest, 0.9);
  EXPECT_GT(lowest, 0.1);
  EXPECT_GT(state.positions.back()[2], 0.4);
}

TEST(ClothScene, CountsWhatCrossesAtTheStart) {
  const Scene scene = parse_scene(R"({"selvage_scene": 1, "frames": 1, "bodies": [
      {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.5}},
      {"mesh": {"shape": "cloth", "size": [1, 1, 0], "cell": 0.5}, "rotate": {"axis": [1, 0, 0], "degrees": 90},
       "translate": [0.01, 0.26, -0.45]},
      {"mesh": {"shape": "box", "size": [1, 1, 1]}, "translate": [0.77, 0.77, -0.5]}]})",
                                  "scene.json");
  const TemporaryFolder folder;
  RunOptions options;
  options.folder = folder.path();
  options.frames = 0;
  const RunReport report = run_scene(scene, options);
  const auto& pairs = report.crossings.bodies.pairs;
  ASSERT_GE(pairs.size(), 2u);
  EXPECT_EQ(pairs[0].first, 0);
  EXPECT_EQ(pairs[0].second, 1);
  EXPECT_GT(pairs[0].triangle_pairs, 2);
  EXPECT_EQ(pairs[0].vertices, 0);
  EXPECT_EQ(pairs[1].second, 2);
  EXPECT_EQ(pairs[1].vertices, 1);  // the corner of the first sheet, inside the box
  EXPECT_EQ(guaranteed_from(report.frames), std::nullopt);
}

}  // namespace
}  // namespace selvage
