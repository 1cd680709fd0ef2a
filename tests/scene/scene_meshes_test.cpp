// Meshes of a scene: curves of rods, meshes moved to the origin, values in place of the file's.
#include "selvage/core/error.h"
#include "selvage/scene/scene.h"
#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

Scene scene_of_mesh(const std::string& mesh, const std::string& more = "") {
  return parse_scene(R"({"selvage_scene": 1, "bodies": [{"mesh": )" + mesh + more + "}]}", "scene.json");
}

std::string refused_mesh(const std::string& mesh) {
  try {
    scene_of_mesh(mesh);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(SceneMeshes, RodsFollowCurves) {
  EXPECT_EQ(scene_of_mesh(R"({"shape": "rod", "curve": "trefoil", "cell": 0.2})").model.rest_positions,
            make_shape("trefoil", {.cell = 0.2}).positions);
  EXPECT_EQ(scene_of_mesh(R"({"shape": "rod", "curve": "coil", "length": 8})").model.rest_positions,
            make_shape("noodle", {.length = 8.0}).positions);
  EXPECT_EQ(scene_of_mesh(R"({"shape": "rod", "curve": "straight"})").model.rest_positions,
            make_shape("rod").positions);
  EXPECT_NE(refused_mesh(R"({"shape": "rod", "curve": "bow"})").find("bodies[0].mesh.curve"), std::string::npos);
  EXPECT_NE(refused_mesh(R"({"shape": "rod", "curve": "bow"})").find("nested-overhand"), std::string::npos);
  EXPECT_NE(refused_mesh(R"({"shape": "box", "curve": "coil"})").find("is for rods only"), std::string::npos);
  EXPECT_THROW(shape_along_curve("bow"), Error);
}

TEST(SceneMeshes, ClothHasTwoLengths) {
  EXPECT_EQ(scene_of_mesh(R"({"shape": "cloth", "size": [2, 1], "cell": 0.5})").model.rest_positions,
            scene_of_mesh(R"({"shape": "cloth", "size": [2, 1, 0], "cell": 0.5})").model.rest_positions);
  EXPECT_NE(refused_mesh(R"({"shape": "cloth", "size": [2, 0]})").find("mesh.size[1]"), std::string::npos);
  EXPECT_NE(refused_mesh(R"({"shape": "box", "size": [2, 1]})").find("use [x, y, z]"), std::string::npos);
}

TEST(SceneMeshes, ATwistWithoutCrossingsThrowsNoLoop) {
  const auto twisted = [](const std::string& crossings) {
    return scene_of_mesh(R"({"shape": "beam", "size": [20, 0.5, 0.5], "cell": 0.5})",
                         R"(, "poses": [{"pose": "twist", "axis": "x", "turns": 0.25)" + crossings + "}]");
  };
  const Scene scene = twisted(R"(, "crossings": 0)");
  for (std::size_t v = 0; v < scene.model.rest_positions.size(); ++v)
    EXPECT_NEAR(scene.initial_state.positions[v][0], scene.model.rest_positions[v][0], 1e-12);
  EXPECT_NE(twisted("").initial_state.positions, scene.initial_state.positions);
}

TEST(SceneMeshes, CentreComesBeforeRegionsAndPlaces) {
  const Scene scene =
      scene_of_mesh(R"({"shape": "box", "size": [2, 4, 6], "cell": 1, "centre": true})",
                    R"(, "translate": [0, 0, 9], "pinned": [{"box": {"min": [-1, -2, -3], "max": [-1, 2, 3]}}])");
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : scene.model.rest_positions) sum += p;
  EXPECT_LT((sum / static_cast<double>(scene.model.rest_positions.size()) - Vec3(0, 0, 9)).norm(), 1e-12);
  ASSERT_EQ(scene.handles.size(), 1u);
  EXPECT_EQ(scene.handles[0].vertices.size(), 35u);
  EXPECT_NE(refused_mesh(R"({"shape": "box", "centre": 1})").find("true or false"), std::string::npos);
}

TEST(SceneMeshes, ChangesComeAfterTheScale) {
  const std::string text = R"({"selvage_scene": 1, "bodies": [{"mesh": {"shape": "box", "cell": 0.5}}],
    "scales": {"fine": {"/bodies/0/mesh/cell": 0.25}}})";
  const auto vertices = [&](std::string_view scale, const std::vector<std::string>& changes) {
    return parse_scene(text, "scene.json", scale, changes).model.mesh.vertex_count();
  };
  EXPECT_EQ(vertices("", {}), 27);
  EXPECT_EQ(vertices("fine", {}), 125);
  EXPECT_EQ(vertices("fine", {"/bodies/0/mesh/cell=1"}), 8);
  EXPECT_EQ(vertices("", {"/bodies/0/mesh/cell=1", "/bodies/0/mesh/cell=0.25"}), 125);
  EXPECT_NE(parse_scene(text, "scene.json", "", std::vector<std::string>{"/substeps=7"}).fingerprint,
            parse_scene(text, "scene.json").fingerprint);
}

}  // namespace
}  // namespace selvage
