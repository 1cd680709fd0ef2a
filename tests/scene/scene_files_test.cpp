#include "io/whole_file.h"
#include "scene/description/scene_description.h"
#include "scene/frame_measures.h"
#include "selvage/boundary_path/boundary_path.h"
#include "selvage/scene/scene.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

namespace fs = std::filesystem;

/// A row of SPB table 1, as far as a scene decides it.
struct PaperRow {
  const char* scene;
  double vertices, elements;
  int substeps, iterations;
};

constexpr std::array kRows{
    PaperRow{"flattened_ball", 774e3, 2.81e6, 50, 3}, PaperRow{"twisted_beam", 400e3, 1.9e6, 50, 3},
    PaperRow{"twisted_rods", 281e3, 1.3e6, 50, 3},    PaperRow{"nested_knot", 38.1e3, 103e3, 30, 3},
    PaperRow{"two_balls", 418e3, 1.4e6, 50, 3},       PaperRow{"tangled_noodle", 40e3, 110e3, 20, 3},
    PaperRow{"tangled_ball", 219e3, 704e3, 50, 3},    PaperRow{"octopi_16", 3.1e6, 8.88e6, 20, 3},
    PaperRow{"balls_16", 3.5e6, 11.2e6, 50, 3},       PaperRow{"long_noodle", 860e3, 2.29e6, 20, 3},
    PaperRow{"octopi_8_ccd", 40e3, 118e3, 5, 5},      PaperRow{"octopi_8_dcd", 40e3, 118e3, 5, 5},
    PaperRow{"octopi_8_hybrid", 40e3, 118e3, 5, 5},
};

fs::path scene_path(const std::string& name) {
  return fs::path(SELVAGE_SCENES) / (name + ".json");
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(SELVAGE_SCENES))
    if (entry.is_regular_file()) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class SceneFiles : public testing::TestWithParam<std::string> {};

TEST_P(SceneFiles, BeginInOrder) {
  const Scene scene = read_scene(scene_path(GetParam()));
  EXPECT_LT(scene.model.mesh.element_count(), 400'000);  // All frames in minutes on two cores.
  const BoundaryPathFinder<3> finder(scene.model.mesh, scene.initial_state.positions);
  EXPECT_EQ(finder.defects().inverted_elements, 0);
  const bool tangled = GetParam() == "tangled_noodle";
  EXPECT_EQ(!finder.find_penetrating_vertices().empty(), tangled);
  // Sheets and edges cross without a vertex inside.
  FrameStatistics row;
  FrameMeasures(scene).measure(scene.initial_state, 0, row);
  EXPECT_EQ(row.triangle_pairs > 0, tangled);
}

INSTANTIATE_TEST_SUITE_P(All, SceneFiles, testing::ValuesIn(scene_names()),
                         [](const auto& param) { return param.param; });

TEST(SceneFilesOfThePaper, EachRowOfItsTableIsThere) {
  const auto names = scene_names();
  for (const PaperRow& row : kRows)
    EXPECT_TRUE(std::find(names.begin(), names.end(), row.scene) != names.end()) << row.scene;
}

TEST(SceneFilesOfThePaper, EachHasThatScale) {
  for (const std::string& name : scene_names())
    EXPECT_NO_THROW(describe_scene(read_whole_file(scene_path(name)), scene_path(name), "paper")) << name;
}

TEST(SceneFilesOfThePaper, StepsAreThoseOfThePaper) {
  for (const PaperRow& row : kRows) {
    const fs::path path = scene_path(row.scene);
    const SceneDescription scene = describe_scene(read_whole_file(path), path, "paper");
    EXPECT_EQ(scene.substeps, row.substeps) << row.scene;
    EXPECT_EQ(scene.options.iterations, row.iterations) << row.scene;
  }
}

/// Makes the meshes of each body once: minutes for all.
TEST(SceneFilesOfThePaper, CountsAreThoseOfThePaper) {
  for (const PaperRow& row : kRows) {
    if (row.elements > 200e3 && test::scaled(1) < 2) continue;
    const fs::path path = scene_path(row.scene);
    const SceneDescription scene = describe_scene(read_whole_file(path), path, "paper");
    double vertices = 0, elements = 0;
    for (const BodyDescription& body : scene.bodies) {
      const IndexedMesh mesh = make_shape(body.mesh.shape, body.mesh.options);
      const auto copies = static_cast<double>(body.instances.size());
      vertices += copies * static_cast<double>(mesh.positions.size());
      elements += copies * static_cast<double>(mesh.tetrahedra.size());
    }
    EXPECT_NEAR(vertices / row.vertices, 1, 0.1) << row.scene << ": " << vertices;
    EXPECT_NEAR(elements / row.elements, 1, 0.1) << row.scene << ": " << elements;
  }
}

}  // namespace
}  // namespace selvage
