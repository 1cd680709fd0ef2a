#include "selvage/mesh/weld.h"

#include "selvage/core/error.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace selvage {
namespace {

TEST(FirstInPlace, IsTheFirstWithTheSameCoordinates) {
  const std::vector<Vec3> p{{1, 0, 0}, {0, 0, 0}, {1, -0.0, 0}, {0, 0, 1e-300}, {0, -0.0, -0.0}};
  EXPECT_EQ(find_first_in_place(p), (std::vector<Index>{0, 1, 0, 3, 1}));
  EXPECT_TRUE(find_first_in_place({}).empty());
  const std::vector<Vec3> end{{1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 2}};
  EXPECT_EQ(find_first_in_place(p, end), (std::vector<Index>{0, 1, 0, 3, 4}));
  EXPECT_THROW(find_first_in_place(p, std::span(end).first(2)), Error);
}

/// Every triangle with vertices of its own, in random order of its corners.
IndexedMesh apart(const IndexedMesh& mesh) {
  IndexedMesh result;
  std::mt19937 engine(7);
  for (VertexTuple<3> t : mesh.triangles) {
    std::rotate(t.begin(), t.begin() + engine() % 3, t.end());
    const auto first = static_cast<Index>(result.positions.size());
    for (const Index v : t) result.positions.push_back(mesh.positions[v]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(Weld, RestoresASurface) {
  const IndexedMesh cloth = make_cloth(1, 1, 0.1);
  IndexedMesh mesh = apart(cloth);
  EXPECT_TRUE(weld_triangles(mesh, find_first_in_place(mesh.positions)).empty());
  const auto edges_of = [](const IndexedMesh& m) {
    return TriangleMesh(static_cast<Index>(m.positions.size()), m.triangles).edge_count();
  };
  EXPECT_EQ(mesh.positions.size(), 3 * cloth.triangles.size()) << "vertices stay";
  EXPECT_EQ(edges_of(mesh), edges_of(cloth));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.positions[mesh.triangles[t][k]], apart(cloth).positions[3 * t + k]);
}

TEST(Weld, RemovesTrianglesWithoutThreeCorners) {
  IndexedMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  mesh.triangles = {{0, 3, 1}, {0, 1, 2}, {3, 2, 0}, {3, 2, 1}};
  mesh.faces = {0, 0, 1, 2};
  mesh.groups = {1, 0, 1, 1};
  EXPECT_EQ(weld_triangles(mesh, find_first_in_place(mesh.positions)), (std::vector<Index>{1, 3}));
  EXPECT_EQ(mesh.triangles, (std::vector<VertexTuple<3>>{{0, 1, 2}, {0, 2, 1}}));
  EXPECT_EQ(mesh.faces, (std::vector<Index>{0, 2}));
  EXPECT_EQ(mesh.groups, (std::vector<Index>{0, 1}));
  EXPECT_THROW(weld_triangles(mesh, {}), Error);
  IndexedMesh solid = make_box({1, 1, 1}, 1);
  EXPECT_THROW(weld_triangles(solid, find_first_in_place(solid.positions)), Error);
}

TEST(ConnectedPieces, AreJoinedByVertices) {
  const TriangleMesh mesh(9, {{0, 1, 2}, {3, 4, 5}, {2, 6, 7}, {5, 4, 8}});
  EXPECT_EQ(connected_pieces(mesh), (std::vector<Index>{0, 1, 0, 1}));
}

}  // namespace
}  // namespace selvage
