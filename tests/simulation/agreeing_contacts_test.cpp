#include "simulation/agreeing_contacts.h"

#include "selvage/mesh/shapes.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// Two boxes apart; their vertices are two regions.
struct TwoBoxes {
  MeshFile file = concatenate(std::array{make_box(Vec3::Ones(), 0.5), make_box(Vec3::Ones(), 0.5)});
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};
  Index second = mesh.vertex_count() / 2;  ///< its first vertex
};

/// Of all that a contact has only what its crossing is told by.
Contact contact(Index point, Index surface, const Vec3& normal) {
  Contact contact;
  contact.count = 2;
  contact.vertices = {point, surface};
  contact.weights = {1, -1};
  contact.normal = normal;
  contact.point_feature = point;
  return contact;
}

std::vector<Index> points_of(std::span<const Contact> contacts) {
  std::vector<Index> points;
  for (const Contact& c : contacts) points.push_back(c.point_feature);
  return points;
}

const Vec3 kUp(0, 0, 1), kDown(0, 0, -1), kAside(1, 0, 0);

TEST(AgreeingContacts, FollowTheMostOfTheirCrossing) {
  const TwoBoxes b;
  const std::vector<Contact> contacts{contact(0, b.second, kUp), contact(1, b.second, kUp), contact(3, b.second, kDown),
                                      contact(4, b.second, kAside)};
  EXPECT_EQ(points_of(find_agreeing_contacts(b.mesh, contacts)), (std::vector<Index>{0, 1, 4}));
}

TEST(AgreeingContacts, TakeTheOtherSideInReverse) {
  const TwoBoxes b;
  const Index s = b.second;
  // The first box goes up, so the second goes down.
  const std::vector<Contact> contacts{contact(0, s, kUp), contact(1, s, kUp), contact(s, 0, kUp),
                                      contact(s + 1, 1, kDown)};
  EXPECT_EQ(points_of(find_agreeing_contacts(b.mesh, contacts)), (std::vector<Index>{0, 1, s + 1}));
}

TEST(AgreeingContacts, ChooseOneSideWhereBothPushAlike) {
  const TwoBoxes b;
  const std::vector<Contact> contacts{contact(0, b.second, kUp), contact(1, b.second, kDown), contact(2, b.second, kUp),
                                      contact(3, b.second, kDown)};
  const std::vector<Contact> agreeing = find_agreeing_contacts(b.mesh, contacts);
  ASSERT_EQ(agreeing.size(), 2u);
  EXPECT_EQ(agreeing[0].normal, agreeing[1].normal);
}

TEST(AgreeingContacts, EachCrossingHasItsOwnWay) {
  const TwoBoxes b;
  const MeshFile three = concatenate(std::array{b.file, make_box(Vec3::Ones(), 0.5)});
  const TetMesh mesh(static_cast<Index>(three.positions.size()), three.tetrahedra);
  const Index second = b.second, third = 2 * b.second;
  const std::vector<Contact> contacts{contact(0, second, kUp),  contact(1, second, kUp), contact(0, third, kDown),
                                      contact(1, third, kDown), contact(2, third, kUp),  contact(second, third, kUp),
                                      contact(second, 0, kDown)};
  EXPECT_EQ(points_of(find_agreeing_contacts(mesh, contacts)), (std::vector<Index>{0, 1, 0, 1, second, second}));
}

TEST(AgreeingContacts, StayWithinOneRegion) {
  const TwoBoxes b;
  std::vector<Contact> contacts;
  const auto& element = b.mesh.elements()[0];
  contacts.push_back(contact(element[0], element[1], kUp));
  contacts.push_back(contact(element[1], element[2], kDown));
  contacts.push_back(contact(element[0], element[2], kUp));
  EXPECT_EQ(find_agreeing_contacts(b.mesh, contacts).size(), 3u);
  EXPECT_TRUE(find_agreeing_contacts(b.mesh, {}).empty());
}

}  // namespace
}  // namespace selvage
