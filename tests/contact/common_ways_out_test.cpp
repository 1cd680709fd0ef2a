// Ways out of bodies that cut through each other.
#include "contact/ways_out/common_ways_out.h"
#include "selvage/contact/contact_finder.h"
#include "solids.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage {
namespace {

using solids::Solid;

/// The contacts by paths of bodies that stand in one another.
std::vector<Contact> ways_out(const Solid& solid) {
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions);
  finder.begin_step(solid.positions);
  std::vector<Contact> contacts;
  finder.find_contacts(solid.positions, contacts);
  return contacts;
}

/// Where the first body goes by a contact.
Vec3 way_of_first(const Contact& contact, Index first_count) {
  return contact.vertices[0] < first_count ? contact.normal : Vec3(-contact.normal);
}

TEST(CommonWaysOut, LeadTwoRodsThatCrossApartAcrossBoth) {
  const Solid along_x = solids::box({-1, -0.1, -0.1}, {1, 0.1, 0.1}, 0.1);
  const Solid along_y = solids::box({-0.1, -1, -0.1}, {0.1, 1, 0.1}, 0.1);
  const Solid both = solids::together({along_x, along_y});
  const std::vector<Contact> contacts = ways_out(both);
  ASSERT_GT(contacts.size(), 8u);
  const auto first_count = static_cast<Index>(along_x.positions.size());
  const Vec3 way = way_of_first(contacts[0], first_count);
  EXPECT_NEAR(std::abs(way[2]), 1, 1e-12);
  for (const Contact& contact : contacts) {
    EXPECT_EQ(way_of_first(contact, first_count), way);
    // Straight through the other, not to its nearer side.
    EXPECT_NEAR(contact.point[2], contact.vertices[0] < first_count ? 0.1 * way[2] : -0.1 * way[2], 1e-12);
    EXPECT_LE(gap_of(contact, both.positions), 1e-12);
  }
}

/// A body that is straight along x, turns, and is straight again, so that it runs right through itself.
struct Loop {
  Solid solid;
  std::vector<bool> is_first;  ///< half, of each vertex
};

Loop loop_with_ends(double first, double second, double half_width, double radius, double turn) {
  const double length = first + second + radius * turn;
  Loop loop{solids::box({0, -0.1, -half_width}, {length, 0.1, half_width}, 0.1), {}};
  for (Vec3& p : loop.solid.positions) {
    loop.is_first.push_back(p[0] < first + radius * turn / 2);
    const double angle = std::clamp((p[0] - first) / radius, 0.0, turn);
    const double ahead = p[0] < first ? p[0] - first : std::max(0.0, p[0] - first - radius * turn);
    const double across = radius - p[1];
    p = Vec3(first + std::sin(angle) * across + std::cos(angle) * ahead,
             radius - std::cos(angle) * across + std::sin(angle) * ahead, p[2]);
  }
  return loop;
}

TEST(CommonWaysOut, DrawTheShorterEndOfASheetThatCrossesItselfOut) {
  for (const bool first_is_shorter : {false, true})
    for (const double turn : {1.2 * std::numbers::pi, 1.35 * std::numbers::pi, 1.5 * std::numbers::pi})
      for (const double up : {1.0, -1.0}) {
        const double first = first_is_shorter ? 1.2 : 2;
        auto [sheet, is_first] = loop_with_ends(first, 3.2 - first, 0.8, 0.25, turn);
        for (Vec3& p : sheet.positions) p = Vec3(p[0], up * p[1], up * p[2]);
        const std::vector<Contact> contacts = ways_out(sheet);
        ASSERT_GT(contacts.size(), 40u);
        const Vec3 back(-std::cos(turn), -up * std::sin(turn), 0);
        for (const Contact& contact : contacts) {
          const Vec3 way = is_first[contact.vertices[0]] ? contact.normal : Vec3(-contact.normal);
          EXPECT_GT(first_is_shorter ? way[0] : -way.dot(back), -0.1) << turn << ": " << way.transpose();
        }
      }
}

TEST(CommonWaysOut, LeadARodThatCrossesItselfApartAcrossIt) {
  const Loop rod = loop_with_ends(1.5, 1.5, 0.1, 0.5, 1.5 * std::numbers::pi);
  const std::vector<Contact> contacts = ways_out(rod.solid);
  ASSERT_GT(contacts.size(), 8u);
  const auto way_of_first_part = [&](const Contact& contact) {
    return rod.is_first[contact.vertices[0]] ? contact.normal : Vec3(-contact.normal);
  };
  const Vec3 way = way_of_first_part(contacts[0]);
  EXPECT_NEAR(std::abs(way[2]), 1, 1e-12);
  for (const Contact& contact : contacts) {
    EXPECT_EQ(way_of_first_part(contact), way);
    EXPECT_NEAR(contact.point[2], rod.is_first[contact.vertices[0]] ? 0.1 * way[2] : -0.1 * way[2], 1e-12);
  }
}

TEST(CommonWaysOut, LeadABodyInsideAnotherToTheNearestSide) {
  const Solid outer = solids::box({0, 0, 0}, {1, 1, 1}, 0.25),
              inner = solids::box({0.3, 0.3, 0.42}, {0.7, 0.7, 0.82}, 0.2);
  const Solid both = solids::together({outer, inner});
  const std::vector<Contact> contacts = ways_out(both);
  ASSERT_GE(contacts.size(), 26u);
  for (const Contact& contact : contacts) {
    EXPECT_EQ(contact.normal, Vec3(0, 0, 1));
    EXPECT_NEAR(contact.point[2], 1, 1e-12);
  }
}

TEST(CommonWaysOut, LeaveShortestPathsThatAgreeAsTheyAre) {
  // A small block a little in the face of a large one.
  const Solid large = solids::box({0, 0, 0}, {2, 2, 1}, 0.5),
              small = solids::box({0.8, 0.8, 0.97}, {1.2, 1.2, 1.3}, 0.2);
  const Solid both = solids::together({large, small});
  const std::vector<Contact> contacts = ways_out(both);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& contact : contacts)
    EXPECT_EQ(way_of_first(contact, static_cast<Index>(large.positions.size())), Vec3(0, 0, -1));
}

TEST(CommonWaysOut, LeavePointsInTheirOwnPieceWithoutTwoSidesToTheShortestPath) {
  // All are in one element, also its own corners, which cannot be on the other side of themselves.
  test::Random random(7);
  int tested = 0;
  for (const auto& family : solids::families()) {
    const Solid solid = family.make(random);
    const TetMesh mesh = solid.mesh();
    const std::vector<Index> pieces = mesh.element_components();
    if (*std::max_element(pieces.begin(), pieces.end()) > 0) continue;
    const CommonWaysOut common(mesh);
    std::vector<PenetratingPoint> points;
    for (const Index v : mesh.boundary_vertices()) points.push_back(penetrating_vertex(v, 0, solid.positions));
    std::vector<BoundaryPath<3>> paths(points.size());
    for (BoundaryPath<3>& path : paths) path.status = PathStatus::kFound, path.point = Vec3::Zero();
    common.apply(solid.positions, points, paths);
    for (const BoundaryPath<3>& path : paths) EXPECT_EQ(path.face, kNone) << family.name;
    std::vector<Index> all(mesh.boundary_vertices().begin(), mesh.boundary_vertices().end());
    all.insert(all.end(), mesh.elements()[0].begin(), mesh.elements()[0].end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    EXPECT_EQ(common.vertices_in_folds(points), all) << family.name;
    ++tested;
  }
  EXPECT_GT(tested, 0);
}

/// Two blocks of which one is folded into itself; then the other is in it, too, and then each in itself alone.
TEST(CommonWaysOut, TellFoldsOfPiecesInWhichNothingElseIs) {
  const Solid one = solids::box({0, 0, 0}, {1, 1, 1}, 0.5), other = solids::box({2, 0, 0}, {3, 1, 1}, 0.5);
  const Solid both = solids::together({one, other});
  const TetMesh mesh = both.mesh();
  const CommonWaysOut common(mesh);
  const Index of_one = 0, of_other = static_cast<Index>(one.elements.size());
  std::vector<Index> fold(mesh.elements()[of_one].begin(), mesh.elements()[of_one].end());
  std::sort(fold.begin(), fold.end());
  std::vector<PenetratingPoint> points{penetrating_vertex(fold[0], of_one, both.positions)};
  EXPECT_EQ(common.vertices_in_folds(points), fold);
  const Index other_corner = mesh.elements()[of_other][0];
  points.push_back(penetrating_vertex(other_corner, of_one, both.positions));
  EXPECT_TRUE(common.vertices_in_folds(points).empty());
  points.back() = penetrating_vertex(other_corner, of_other, both.positions);
  EXPECT_EQ(common.vertices_in_folds(points).size(), 8u);
}

TEST(CommonWaysOut, AreTheSameForAnyNumberOfThreadsAndEndOnTheBoundary) {
  test::Random random(3);
  for (const auto& family : solids::families()) {
    const Solid solid = solids::together({family.make(random), family.make(random)});
    const auto contacts = test::with_threads(1, [&] { return ways_out(solid); });
    const auto again = test::with_threads(4, [&] { return ways_out(solid); });
    ASSERT_EQ(contacts.size(), again.size()) << family.name;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts[i].normal, again[i].normal);
      EXPECT_EQ(contacts[i].weights, again[i].weights);
      double sum = 0, size = 0;
      for (int k = 0; k < contacts[i].count; ++k)
        sum += contacts[i].weights[k], size += std::abs(contacts[i].weights[k]);
      EXPECT_NEAR(sum, 0, 1e-9) << family.name;
      EXPECT_LE(size, 2 + 1e-9);
      EXPECT_NEAR(contacts[i].normal.norm(), 1, 1e-9);
    }
  }
}

}  // namespace
}  // namespace selvage
