// Cloth among the bodies of a contact finder: met from both sides, without an inside, held off by its thickness.
#include "contact_steps.h"
#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace selvage {
namespace {

using Positions = std::vector<Vec3>;

/// Two triangles of cloth without a common vertex: a wide one in the plane z = 0, and one that stands on its tip over
/// its middle.
struct TwoTriangles {
  TetMesh mesh = TetMesh::without_elements(6);
  std::vector<VertexTuple<3>> triangles{{0, 1, 2}, {3, 4, 5}};

  Positions with_tip(double height) const {
    const double up = height < 0 ? -1 : 1;
    return {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}, {0, 0, height}, {0.1, 0, height + up}, {0, 0.1, height + up}};
  }
};

TEST(ClothContacts, AFaceIsMetFromBothSides) {
  const TwoTriangles s;
  for (const double from : {0.1, -0.1}) {
    const Positions t0 = s.with_tip(from);
    Positions t1 = t0;
    t1[3][2] = -from;
    ContactFinder finder(s.mesh, {}, t0, {}, {}, {}, {s.triangles, {}});
    const auto contacts = test::contacts_of_step(finder, t0, t1);
    ASSERT_FALSE(contacts.empty());
    EXPECT_EQ(contacts[0].kind, ContactKind::kVertexFace);
    EXPECT_EQ(contacts[0].point_feature, 3);
    EXPECT_EQ(contacts[0].surface_feature, 0);
    EXPECT_NEAR(contacts[0].normal[2], from > 0 ? 1 : -1, 1e-12);
    EXPECT_NEAR(contacts[0].time, 0.5, 1e-5);
    EXPECT_EQ(contacts[0].distance, 0);
    EXPECT_FALSE(finder.find_impacts(t1).pairs.empty());
    EXPECT_TRUE(finder.find_impacts(t0).pairs.empty());
    EXPECT_EQ(finder.statistics().unguarded_vertices, 0);
  }
}

TEST(ClothContacts, WhatIsNearIsHeldOffByTheThickness) {
  const TwoTriangles s;
  const std::vector<double> thickness(6, 0.02);
  Positions rest = s.with_tip(3);
  for (const auto& [height, is_near] : {std::pair(0.05, true), std::pair(-0.05, true), std::pair(0.07, false)}) {
    const Positions t0 = s.with_tip(height);
    ContactFinder finder(s.mesh, rest, t0, {}, {}, {}, {s.triangles, thickness});
    const auto contacts = test::contacts_of_step(finder, t0, t0);
    ASSERT_EQ(!contacts.empty(), is_near) << height;
    if (!is_near) continue;
    EXPECT_EQ(contacts[0].kind, ContactKind::kVertexFace);
    EXPECT_EQ(contacts[0].point_feature, 3);
    EXPECT_DOUBLE_EQ(contacts[0].distance, 0.04);
    EXPECT_NEAR(contacts[0].normal[2], height > 0 ? 1 : -1, 1e-12);
    EXPECT_NEAR(gap_of(contacts[0], t0), std::abs(height), 1e-12);
  }
  // As near at rest: left alone, but for two objects.
  const Positions near = s.with_tip(0.03);
  ContactFinder one(s.mesh, near, near, {}, {}, {}, {s.triangles, thickness});
  EXPECT_TRUE(test::contacts_of_step(one, near, near).empty());
  const std::vector<Index> objects{0, 0, 0, 1, 1, 1};
  ContactFinder two(s.mesh, near, near, objects, {}, {}, {s.triangles, thickness});
  EXPECT_FALSE(test::contacts_of_step(two, near, near).empty());
}

// Where only rounding is between the nearest points, their difference may be a hundred times the distance.
TEST(ClothContacts, NormalsOfWhatNearlyTouchesHaveALengthOfOne) {
  const TwoTriangles s;
  const std::vector<double> thickness(6, 0.02);
  test::Random random(test::seed(95));
  int faces = 0, edges = 0;
  for (std::int64_t n = 0; n < test::scaled(300); ++n) {
    const Eigen::AngleAxisd turn(random.within(0, 3), random.vector(1).normalized());
    const Vec3 shift = random.vector(0.3);
    const auto placed = [&](Positions all) {
      // Every other one with edges that cross, in place of a tip.
      if (n % 2 == 0) all = {all[0], all[1], all[2], {-0.5, -2, all[3][2]}, {-0.5, 2, all[3][2]}, {-0.5, 0, 3}};
      for (Vec3& x : all) x = turn * x + shift;
      return all;
    };
    const Positions t0 = placed(s.with_tip(random.within(-1, 1) * std::pow(10, -random.within(12, 19))));
    ContactFinder finder(s.mesh, placed(s.with_tip(5)), t0, {}, {}, {}, {s.triangles, thickness});
    for (const Contact& contact : test::contacts_of_step(finder, t0, t0)) {
      if (contact.distance == 0 || contact.kind == ContactKind::kContour) continue;
      EXPECT_NEAR(contact.normal.norm(), 1, 0.01 + 1e-12);
      EXPECT_GT(gap_of(contact, t0), -1e-15);
      faces += contact.kind == ContactKind::kVertexFace;
      edges += contact.kind == ContactKind::kEdgeEdge;
    }
  }
  EXPECT_GE(faces, test::scaled(50, 0));
  EXPECT_GE(edges, test::scaled(20, 0));
}

TEST(ClothContacts, WhatStandsInElementsIsSentOut) {
  const auto box = solids::box({0, 0, 0}, {1, 1, 1}, 2);
  Positions positions = box.positions;
  const auto first = static_cast<Index>(positions.size());
  positions.insert(positions.end(), {{0.3, 0.4, 0.05}, {0.3, 0.4, -1}, {0.4, 0.5, -1}});
  const TetMesh mesh(first + 3, box.elements);
  const std::vector<VertexTuple<3>> triangles{{first, first + 1, first + 2}};
  ContactFinder finder(mesh, {}, positions, {}, {}, {}, {triangles, {}});
  const auto contacts = test::contacts_of_step(finder, positions, positions);
  ASSERT_FALSE(contacts.empty());
  EXPECT_EQ(contacts[0].kind, ContactKind::kVertexPath);
  EXPECT_EQ(contacts[0].point_feature, first);
  EXPECT_NEAR(contacts[0].normal[2], -1, 1e-12);
  EXPECT_NEAR(gap_of(contacts[0], positions), -0.05, 1e-12);
  EXPECT_EQ(finder.penetrating_vertices()[0], first);
  EXPECT_GT(finder.statistics().unguarded_vertices, 0);
  EXPECT_EQ(finder.surface().triangle_count(), mesh.boundary_face_count() + 1);
}

TEST(ClothContacts, ClothHasVerticesOfItsOwn) {
  const auto box = solids::box({0, 0, 0}, {1, 1, 1}, 2);
  const TetMesh mesh = box.mesh();
  const std::vector<VertexTuple<3>> triangles{{0, 1, 2}};
  EXPECT_THROW(ContactFinder(mesh, {}, box.positions, {}, {}, {}, {triangles, {}}), Error);
  const std::vector<VertexTuple<3>> beyond{{0, 1, mesh.vertex_count()}};
  EXPECT_THROW(ContactFinder(mesh, {}, box.positions, {}, {}, {}, {beyond, {}}), Error);
}

}  // namespace
}  // namespace selvage
