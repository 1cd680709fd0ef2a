// A mesh of vertices alone, as where all of a model is cloth: every search finds nothing, in every pose.
#include "selvage/boundary_path/boundary_path.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

template <int D>
void expect_nothing() {
  const auto mesh = SimplexMesh<D>::without_elements(3);
  EXPECT_EQ(mesh.vertex_count(), 3);
  EXPECT_EQ(mesh.boundary_face_count(), 0);
  EXPECT_TRUE(mesh.edges().empty());
  EXPECT_TRUE(mesh.vertex_elements(2).empty());
  std::vector<Vec<D>> positions(3, Vec<D>::Zero());
  positions[1][0] = 1;
  BoundaryPathFinder<D> finder(mesh, positions);
  for (int pose = 0; pose < 3; ++pose) {
    EXPECT_TRUE(finder.find_penetrating_vertices().empty());
    EXPECT_TRUE(finder.locate(positions).queries.empty());
    EXPECT_TRUE(finder.find_paths({}).empty());
    EXPECT_EQ(finder.defects().inverted_elements, 0);
    positions[2][1] = pose;
    finder.update(positions);
  }
}

TEST(WithoutElements, NothingIsFound) {
  expect_nothing<2>();
  expect_nothing<3>();
}

}  // namespace
}  // namespace selvage
