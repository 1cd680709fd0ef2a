#include "contact/ways_out/path_contact.h"

#include "mesh/simplex_corners.h"
#include "solids.h"

#include <gtest/gtest.h>

#include <cmath>

namespace selvage {
namespace {

using solids::Solid;

TEST(OutwardNormal, IsAreaWeightedAtEdgesAndVertices) {
  const Solid solid = solids::box({0, 0, 0}, {1, 1, 1}, 1);
  const TetMesh mesh = solid.mesh();
  for (Index f = 0; f < mesh.boundary_face_count(); ++f) {
    const auto& corners = mesh.boundary_faces()[f];
    const Vec3 own = outward_normal(mesh, solid.positions, f, {0.2, 0.3, 0.5});
    EXPECT_NEAR(own.cwiseAbs().maxCoeff(), 1, 1e-15);
    for (int i = 0; i < 3; ++i) {
      std::array<double, 3> at_vertex{0, 0, 0};
      at_vertex[i] = 1;
      Vec3 sum = Vec3::Zero();
      for (const Index other : mesh.vertex_boundary_faces(corners[i]))
        sum += area_normal(corners_of(mesh.boundary_faces()[other], solid.positions));
      EXPECT_LE((outward_normal(mesh, solid.positions, f, at_vertex) - sum.normalized()).norm(), 1e-15);
      const Index beyond = mesh.boundary_neighbours()[f][i];
      std::array<double, 3> on_edge{0.5, 0.5, 0.5};
      on_edge[i] = 0;
      const Vec3 both = area_normal(corners_of(corners, solid.positions)) +
                        area_normal(corners_of(mesh.boundary_faces()[beyond], solid.positions));
      EXPECT_LE((outward_normal(mesh, solid.positions, f, on_edge) - both.normalized()).norm(), 1e-15);
    }
  }
}

/// A vertex that the point and the surface have in common, with the same weight, moves nothing and is not listed.
TEST(PathContact, ListsNoVertexWithoutWeight) {
  const Solid solid = solids::box({0, 0, 0}, {1, 1, 1}, 1);
  const TetMesh mesh = solid.mesh();
  const auto& [a, b, c] = mesh.boundary_faces()[0];
  const Index other = mesh.elements()[mesh.boundary_owners()[0].element()][mesh.boundary_owners()[0].face()];
  BoundaryPath<3> path;
  path.face = 0;
  path.barycentric = Vec3(0.25, 0.75, 0);
  const PenetratingPoint point = penetrating_edge(0, {a, other}, 0.75, 0, solid.positions);
  const Contact contact = path_contact(mesh, point, path);
  ASSERT_EQ(contact.count, 2);
  EXPECT_EQ(contact.vertices[0], other);
  EXPECT_EQ(contact.weights[0], 0.75);
  EXPECT_EQ(contact.vertices[1], b);
  EXPECT_EQ(contact.weights[1], -0.75);
  path.barycentric = Vec3(0.125, 0.25, 0.625);
  const Contact whole = path_contact(mesh, point, path);
  ASSERT_EQ(whole.count, 4);
  EXPECT_EQ(whole.weights[0], 0.125);
  EXPECT_EQ(whole.vertices[3], c);
}

}  // namespace
}  // namespace selvage
