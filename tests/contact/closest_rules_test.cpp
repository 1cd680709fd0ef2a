#include "contact/closest_rules.h"

#include "mesh/simplex_corners.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using solids::Solid;

Solid two_balls(double distance) {
  Solid solid = solids::together({solids::of(make_ball(1, 0.3)), solids::of(make_ball(1, 0.3))});
  for (std::size_t v = solid.positions.size() / 2; v < solid.positions.size(); ++v)
    solid.positions[v] += Vec3(distance, 0.013, 0.017);
  return solid;
}

std::vector<Contact> contacts_of(const Solid& solid, const std::vector<Vec3>& rest, ClosestPointRule rule) {
  const TetMesh mesh = solid.mesh();
  ContactOptions options;
  options.mode = DetectionMode::kDcd;
  options.rule = rule;
  ContactFinder finder(mesh, rest, solid.positions, {}, options);
  std::vector<Contact> contacts;
  finder.begin_step(solid.positions);
  finder.find_contacts(solid.positions, contacts);
  return contacts;
}

TEST(ClosestRules, AgreeOnUndeformedBalls) {
  const Solid solid = two_balls(1.6);
  const auto expected = contacts_of(solid, {}, ClosestPointRule::kShortestPath);
  ASSERT_GT(expected.size(), 10);
  for (const ClosestPointRule rule : {ClosestPointRule::kRestPose, ClosestPointRule::kEuclidean}) {
    const auto contacts = contacts_of(solid, solid.positions, rule);
    ASSERT_EQ(contacts.size(), expected.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts[i].point_feature, expected[i].point_feature);
      EXPECT_LE((contacts[i].point - expected[i].point).norm(), 1e-7);
      EXPECT_LE((contacts[i].normal - expected[i].normal).norm(), 1e-6);
    }
  }
}

TEST(ClosestRules, TheRestPoseIsWhereTheClosestPointIsSought) {
  // A bar squeezed flat in z: near the middle of its height the sides are closest at rest, top and bottom now.
  const Solid at_rest =
      solids::together({solids::box({0, 0, 0}, {1, 1, 4}, 1),
                        solids::tetrahedron({Vec3{0.1, 0.45, 0.5}, {-2, 0, 0}, {-2, 1, 0}, {-2, 0, 1}})});
  Solid now = at_rest;
  for (Vec3& x : now.positions) x[2] *= 0.05;
  const auto vertex = static_cast<Index>(at_rest.positions.size() - 4);
  const auto contact_of = [&](ClosestPointRule rule) {
    for (const Contact& contact : contacts_of(now, at_rest.positions, rule))
      if (contact.kind == ContactKind::kVertexPath && contact.point_feature == vertex) return contact;
    return Contact{};
  };
  EXPECT_LE((contact_of(ClosestPointRule::kShortestPath).normal - Vec3(0, 0, -1)).norm(), 1e-9);
  EXPECT_LE((contact_of(ClosestPointRule::kEuclidean).normal - Vec3(0, 0, -1)).norm(), 1e-9);
  const Contact rest = contact_of(ClosestPointRule::kRestPose);
  EXPECT_LE((rest.normal - Vec3(-1, 0, 0)).norm(), 1e-9);
  EXPECT_LE((rest.point - Vec3(0, 0.45, 0.025)).norm(), 1e-7);
}

TEST(ClosestRules, EuclideanIsTheClosestOfAllFacesOfTheOtherObject) {
  const Solid solid = two_balls(0.9);
  const TetMesh mesh = solid.mesh();
  EuclideanRule rule(mesh, {});
  rule.place(solid.positions);
  test::Random random(test::seed(1));
  const Index half = mesh.element_count() / 2;
  for (std::int64_t n = 0; n < test::scaled(200); ++n) {
    const Vec3 point = random.vector(2);
    const Index element = random.below(mesh.element_count());
    double least = HUGE_VAL;
    for (Index f = 0; f < mesh.boundary_face_count(); ++f) {
      if ((mesh.boundary_owners()[f].element() < half) != (element < half)) continue;
      const auto [a, b, c] = corners_of(mesh.boundary_faces()[f], solid.positions);
      least = std::min(least, closest_point_on_triangle(point, a, b, c).squared_distance);
    }
    const BoundaryPath<3> path = rule.find({point, element}, solid.positions);
    ASSERT_EQ(path.status, PathStatus::kFound);
    EXPECT_DOUBLE_EQ(path.distance, std::sqrt(least));
    EXPECT_NEAR((path.point - point).norm(), path.distance, 1e-12);
    EXPECT_EQ(mesh.boundary_owners()[path.face].element() < half, element < half);
  }
}

}  // namespace
}  // namespace selvage
