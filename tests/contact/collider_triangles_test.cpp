// Surfaces that meet the mesh but not one another.
#include "selvage/contact/contact_finder.h"
#include "selvage/core/error.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using Positions = std::vector<Vec3>;

/// A box, and after its vertices a triangle with a tip at a place, upright under it.
struct Setting {
  solids::Solid box = solids::box({0, 0, 0}, {1, 1, 1}, 2);
  TetMesh mesh = box.mesh();
  Index first = mesh.vertex_count();
  std::vector<VertexTuple<3>> triangles{{first, first + 1, first + 2}};

  Positions with_tip(const Vec3& tip) const {
    Positions all = box.positions;
    all.push_back(tip);
    all.push_back(tip + Vec3(-0.02, 0.01, -3));
    all.push_back(tip + Vec3(0.02, 0.01, -3));
    return all;
  }
};

std::vector<Contact> contacts_of(ContactFinder& finder, const Positions& t0, const Positions& t1) {
  std::vector<Contact> contacts;
  finder.begin_step(t0);
  finder.find_contacts(t1, contacts);
  return contacts;
}

TEST(ColliderTriangles, AVertexThatRunsIntoAFaceMeetsIt) {
  const Setting s;
  const Vec3 below(0.3, 0.4, -0.1), above(0.3, 0.4, 0.1);
  ContactFinder finder(s.mesh, {}, s.with_tip(below), {}, {}, s.triangles);
  const auto contacts = contacts_of(finder, s.with_tip(below), s.with_tip(above));
  const auto found = std::find_if(contacts.begin(), contacts.end(),
                                  [](const Contact& c) { return c.kind == ContactKind::kVertexFace; });
  ASSERT_NE(found, contacts.end());
  EXPECT_EQ(found->vertices[0], s.first);
  EXPECT_NEAR(found->normal[2], -1, 1e-12);
  EXPECT_NEAR(found->time, 0.5, 1e-5);
  EXPECT_LT(gap_of(*found, s.with_tip(above)), 0);
}

TEST(ColliderTriangles, AVertexInsideMovesItsElementAgainstTheShortestPath) {
  const Setting s;
  const Positions inside = s.with_tip({0.3, 0.4, 0.05});
  ContactFinder finder(s.mesh, {}, inside, {}, {}, s.triangles);
  const auto contacts = contacts_of(finder, inside, inside);
  ASSERT_FALSE(contacts.empty());
  EXPECT_EQ(contacts[0].kind, ContactKind::kVertexPath);
  EXPECT_EQ(contacts[0].point_feature, s.first);
  EXPECT_NEAR(contacts[0].distance, 0.05, 1e-12);
  EXPECT_NEAR((contacts[0].normal - Vec3(0, 0, -1)).norm(), 0, 1e-12);
  Positions out = inside;
  for (Index v = 0; v < s.first; ++v) out[v][2] += 0.05;
  EXPECT_NEAR(gap_of(contacts[0], inside), 0, 1e-12);
  EXPECT_NEAR(gap_of(contacts[0], out), contacts[0].distance, 1e-12);
  ASSERT_EQ(finder.penetrating_vertices().size(), 1U);
  EXPECT_EQ(finder.penetrating_vertices()[0], s.first);
}

TEST(ColliderTriangles, AnEdgeThatRunsIntoAnEdgeMeetsIt) {
  const Setting s;
  // Past the box's upper edge at x = 1.
  Positions t0 = s.box.positions, t1 = s.box.positions;
  for (auto* all : {&t0, &t1}) {
    const double shift = all == &t0 ? 0.1 : -0.1;
    all->insert(all->end(), {Vec3(1.1 + shift, 0.3, 0.9), Vec3(0.7 + shift, 0.3, 1.3), Vec3(3, 0.3, 3)});
  }
  ContactFinder finder(s.mesh, {}, t0, {}, {}, s.triangles);
  const auto contacts = contacts_of(finder, t0, t1);
  EXPECT_TRUE(
      std::any_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.kind == ContactKind::kEdgeEdge; }));
}

TEST(ColliderTriangles, DoNotMeetOneAnotherNorVerticesOfTheMesh) {
  const Setting s;
  std::vector<VertexTuple<3>> crossing = s.triangles;
  crossing.push_back({s.first + 3, s.first + 4, s.first + 5});
  Positions apart = s.with_tip({0.3, 0.4, -5});
  apart.insert(apart.end(), {Vec3(-1, 0.4, -6), Vec3(1, 0.4, -6), Vec3(0.3, 1, -6.5)});
  ContactFinder finder(s.mesh, {}, apart, {}, {}, crossing);
  EXPECT_TRUE(contacts_of(finder, apart, apart).empty());
  EXPECT_TRUE(finder.find_impacts(apart).pairs.empty());
  // A wide triangle that the whole box falls through: its corners and edges are far from the box.
  const auto plate = [&](double z) {
    Positions all = s.box.positions;
    all.insert(all.end(), {Vec3(-9, -9, z), Vec3(9, -9, z), Vec3(0, 19, z)});
    return all;
  };
  ContactFinder wide(s.mesh, {}, plate(-0.1), {}, {}, s.triangles);
  EXPECT_TRUE(contacts_of(wide, plate(-0.1), plate(-0.05)).empty());
  EXPECT_TRUE(contacts_of(wide, plate(-0.1), plate(2)).empty()) << "vertices through a face are not asked for";
}

TEST(ColliderTriangles, WithoutAnyAllIsAsBefore) {
  const Setting s;
  ContactFinder finder(s.mesh, {}, s.box.positions);
  EXPECT_EQ(finder.surface().triangle_count(), s.mesh.boundary_face_count());
  EXPECT_TRUE(contacts_of(finder, s.box.positions, s.box.positions).empty());
}

TEST(ColliderTriangles, ImpossibleOnesAreRefused) {
  const Setting s;
  const Positions all = s.with_tip({0, 0, -1});
  for (const auto& triangle :
       {VertexTuple<3>{0, s.first, s.first + 1}, {s.first, s.first + 1, s.first + 3}, {-1, s.first, s.first + 1}})
    EXPECT_THROW(ContactFinder(s.mesh, {}, all, {}, {}, std::vector<VertexTuple<3>>{triangle}), Error);
  EXPECT_THROW(ContactFinder(s.mesh, {}, all), Error) << "positions of no vertex";
  ContactFinder finder(s.mesh, {}, all, {}, {}, s.triangles);
  EXPECT_THROW(finder.begin_step(s.box.positions), Error);
}

}  // namespace
}  // namespace selvage
