#include "untangling/solids/agreeing_contacts.h"

#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

/// Two boxes apart; their vertices are two regions.
struct TwoBoxes {
  IndexedMesh file = concatenate(std::array{make_box(Vec3::Ones(), 0.5), make_box(Vec3::Ones(), 0.5)});
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

/// All of them found now.
std::vector<Contact> agreeing(const TwoBoxes& boxes, const std::vector<Contact>& contacts) {
  return find_agreeing_contacts(boxes.mesh, boxes.file.positions, contacts, 0).contacts;
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
  EXPECT_EQ(points_of(agreeing(b, contacts)), (std::vector<Index>{0, 1, 4}));
}

TEST(AgreeingContacts, TakeTheOtherSideInReverse) {
  const TwoBoxes b;
  const Index s = b.second;
  // The first box goes up, so the second goes down.
  const std::vector<Contact> contacts{contact(0, s, kUp), contact(1, s, kUp), contact(s, 0, kUp),
                                      contact(s + 1, 1, kDown)};
  EXPECT_EQ(points_of(agreeing(b, contacts)), (std::vector<Index>{0, 1, s + 1}));
}

TEST(AgreeingContacts, ChooseOneSideWhereBothPushAlike) {
  const TwoBoxes b;
  const std::vector<Contact> contacts{contact(0, b.second, kUp), contact(1, b.second, kDown), contact(2, b.second, kUp),
                                      contact(3, b.second, kDown)};
  const std::vector<Contact> chosen = agreeing(b, contacts);
  ASSERT_EQ(chosen.size(), 2u);
  EXPECT_EQ(chosen[0].normal, chosen[1].normal);
}

TEST(AgreeingContacts, EachCrossingHasItsOwnWay) {
  const TwoBoxes b;
  const IndexedMesh three = concatenate(std::array{b.file, make_box(Vec3::Ones(), 0.5)});
  const TetMesh mesh(static_cast<Index>(three.positions.size()), three.tetrahedra);
  const Index second = b.second, third = 2 * b.second;
  const std::vector<Contact> contacts{contact(0, second, kUp),  contact(1, second, kUp), contact(0, third, kDown),
                                      contact(1, third, kDown), contact(2, third, kUp),  contact(second, third, kUp),
                                      contact(second, 0, kDown)};
  EXPECT_EQ(points_of(find_agreeing_contacts(mesh, three.positions, contacts, 0).contacts),
            (std::vector<Index>{0, 1, 0, 1, second, second}));
}

/// A bar along x that a box cuts through, nearer to one of its ends; as many contacts send it on as back.
struct CutBar {
  IndexedMesh file = concatenate(std::array{make_box({4, 1, 1}, 0.25), make_box(Vec3::Ones(), 0.5)});
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};
  Index second = mesh.vertex_count() - static_cast<Index>(make_box(Vec3::Ones(), 0.5).positions.size());
  std::vector<Contact> contacts;

  CutBar(double middle, const Vec3& way, bool reversed = false) {
    for (Index v = 0; v < second; ++v) {
      if (std::abs(file.positions[v][0] - middle) > 0.2) continue;
      const double sign = contacts.size() % 2 == 0 ? 1 : -1;
      contacts.push_back(reversed ? contact(second, v, sign * way) : contact(v, second, sign * way));
    }
  }

  AgreeingContacts sorted(std::size_t first_now = 0) const {
    return find_agreeing_contacts(mesh, file.positions, contacts, first_now);
  }
};

TEST(AgreeingContacts, DrawTheShorterEndOfWhatIsCutThrough) {
  for (const double middle : {1.0, 3.0})
    for (const bool reversed : {false, true})
      for (const double sign : {1.0, -1.0}) {
        const CutBar bar(middle, sign * kAside, reversed);
        const AgreeingContacts agreeing = bar.sorted();
        const bool goes_up = (middle < 2) != reversed;
        ASSERT_FALSE(agreeing.contacts.empty());
        EXPECT_LT(agreeing.contacts.size(), bar.contacts.size());
        for (const Contact& c : agreeing.contacts) EXPECT_EQ(c.normal[0], goes_up ? 1 : -1) << middle << reversed;
        EXPECT_EQ(agreeing.drawn_vertices,
                  std::count_if(bar.file.positions.begin(), bar.file.positions.begin() + bar.second,
                                [&](const Vec3& x) { return middle < 2 ? x[0] < 0.8 : x[0] > 3.2; }));
      }
}

TEST(AgreeingContacts, DrawNoEndAcross) {
  const CutBar bar(1, kUp);
  EXPECT_EQ(bar.sorted().drawn_vertices, 0);
}

TEST(AgreeingContacts, DrawNoEndWhereMostPushTheOtherWay) {
  CutBar bar(1, kAside);
  for (Contact& c : bar.contacts)
    if (&c - bar.contacts.data() < std::ssize(bar.contacts) * 4 / 5) c.normal = -kAside;
  const AgreeingContacts agreeing = bar.sorted();
  EXPECT_EQ(agreeing.drawn_vertices, 0);
  for (const Contact& c : agreeing.contacts) EXPECT_EQ(c.normal, -kAside);
}

// A part that has been drawn through is held for a while: it is no longer where the bar is cut.
TEST(AgreeingContacts, DrawFromWhereSomethingIsInsideNow) {
  CutBar held(2.5, kAside);
  const CutBar now(3, kAside);
  const std::size_t first_now = held.contacts.size();
  held.contacts.insert(held.contacts.end(), now.contacts.begin(), now.contacts.end());
  EXPECT_EQ(held.sorted(first_now).drawn_vertices, now.sorted().drawn_vertices);
  EXPECT_GT(held.sorted(0).drawn_vertices, 0);
  EXPECT_EQ(held.sorted(held.contacts.size()).drawn_vertices, 0);
}

TEST(AgreeingContacts, StayWithinOneRegion) {
  const TwoBoxes b;
  std::vector<Contact> contacts;
  const auto& element = b.mesh.elements()[0];
  contacts.push_back(contact(element[0], element[1], kUp));
  contacts.push_back(contact(element[1], element[2], kDown));
  contacts.push_back(contact(element[0], element[2], kUp));
  EXPECT_EQ(agreeing(b, contacts).size(), 3u);
  EXPECT_TRUE(agreeing(b, {}).empty());
}

}  // namespace
}  // namespace selvage
