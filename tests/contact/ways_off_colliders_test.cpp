// Bodies that colliders stand deep in, and the way by which they leave.
#include "selvage/contact/contact_finder.h"
#include "selvage/core/error.h"
#include "solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace selvage {
namespace {

/// A plate across z, and a needle that stands in it. All at rest as it is, but for how much the plate is pressed flat.
struct Pierced {
  Vec3 lower, upper;  ///< of the needle
  double pressed = 1;

  solids::Solid plate = solids::box({-1, -1, -0.1}, {1, 1, 0.1}, 0.1);
  TetMesh mesh = plate.mesh();
  std::vector<Vec3> positions = plate.positions;
  std::vector<VertexTuple<3>> triangles{};
  std::vector<Vec3> asked{};  ///< ways that were asked about
  std::vector<Contact> contacts{};
  ContactStatistics statistics{};

  using Blocks = std::function<bool(const Vec3&)>;

  /// @param blocks  a direction
  std::vector<PieceWayOff> choose(
      const Blocks& blocks = [](const Vec3&) { return false; }, bool has_rest = true) {
    const solids::Solid needle = solids::box(lower, upper, 0.1);
    const TetMesh needle_mesh = needle.mesh();
    for (Vec3& p : positions) p[2] *= pressed;
    positions.insert(positions.end(), needle.positions.begin(), needle.positions.end());
    for (auto [a, b, c] : needle_mesh.boundary_faces())
      triangles.push_back({a + mesh.vertex_count(), b + mesh.vertex_count(), c + mesh.vertex_count()});
    const std::span<const Vec3> rest = has_rest ? std::span<const Vec3>(plate.positions) : std::span<const Vec3>();
    ContactFinder finder(mesh, rest, positions, {}, {}, triangles);
    const auto is_blocked = [&](Index vertex, const Vec3& way) {
      EXPECT_LT(vertex, mesh.vertex_count());
      asked.push_back(way);
      return blocks(way.normalized());
    };
    EXPECT_THROW(finder.choose_ways_off(is_blocked), Error);
    finder.begin_step(positions);
    const auto ways = finder.choose_ways_off(is_blocked);
    finder.find_contacts(positions, contacts);
    statistics = finder.statistics();
    return ways;
  }
};

const Vec3 kUp(0, 0, 1), kDown(0, 0, -1);

/// The needle's edges are cut: the shortest ways out of their upper parts lead up, those of the others down.
TEST(WaysOffColliders, LeadAPlateOffTheNearerEndOfANeedle) {
  Pierced pierced{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}};
  const auto ways = pierced.choose();
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_LT((ways[0].direction - kDown).norm(), 1e-12);
  EXPECT_GT(ways[0].way, 0.1);
  EXPECT_LE(ways[0].way, 0.2 + 1e-12);
  // Its upper side has to come below the needle's lower end.
  EXPECT_LT((pierced.asked[0] - 0.65 * kDown).norm(), 1e-12);
  ASSERT_GT(pierced.contacts.size(), 4u);
  for (const Contact& contact : pierced.contacts) {
    EXPECT_GE(contact.vertices[0], pierced.mesh.vertex_count());
    EXPECT_LT((contact.normal - kUp).norm(), 1e-12);
    EXPECT_NEAR(contact.point[2], 0.1, 1e-12);
  }
}

TEST(WaysOffColliders, LeadAnotherWayWhereThatIsBlocked) {
  Pierced pierced{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}};
  const auto ways = pierced.choose([](const Vec3& direction) { return direction.dot(kDown) > 0.9; });
  ASSERT_EQ(ways.size(), 1u);
  EXPECT_LT((ways[0].direction - kUp).norm(), 1e-12);
  EXPECT_LT((pierced.asked.back() - 0.75 * kUp).norm(), 1e-12);
}

TEST(WaysOffColliders, LeaveShortestPathsWhereAllAreBlocked) {
  Pierced pierced{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}};
  EXPECT_TRUE(pierced.choose([](const Vec3&) { return true; }).empty());
  EXPECT_GT(pierced.asked.size(), 26u);
  const auto is_up = [](const Contact& c) { return c.normal[2] > 0; };
  EXPECT_TRUE(std::any_of(pierced.contacts.begin(), pierced.contacts.end(), is_up));
  EXPECT_FALSE(std::all_of(pierced.contacts.begin(), pierced.contacts.end(), is_up));
}

TEST(WaysOffColliders, AreThereOnlyWhereAColliderStandsDeep) {
  Pierced shallow{{-0.03, -0.02, 0.09}, {0.04, 0.05, 0.65}}, without_rest{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}};
  EXPECT_TRUE(shallow.choose().empty());
  EXPECT_FALSE(shallow.contacts.empty());
  EXPECT_TRUE(shallow.asked.empty());
  EXPECT_TRUE(without_rest.choose([](const Vec3&) { return false; }, false).empty());
}

/// What has been let in has no contact and no way off.
TEST(WaysOffColliders, AreNotForWhatIsLetIn) {
  const solids::Solid plate = solids::box({-1, -1, -0.1}, {1, 1, 0.1}, 0.1),
                      needle = solids::box({-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}, 0.1);
  const TetMesh mesh = plate.mesh(), needle_mesh = needle.mesh();
  std::vector<Vec3> positions = plate.positions;
  positions.insert(positions.end(), needle.positions.begin(), needle.positions.end());
  std::vector<VertexTuple<3>> triangles;
  for (auto [a, b, c] : needle_mesh.boundary_faces())
    triangles.push_back({a + mesh.vertex_count(), b + mesh.vertex_count(), c + mesh.vertex_count()});
  ContactFinder finder(mesh, plate.positions, positions, {}, {}, triangles);
  const std::array<Index, 1> of_needle{triangles[0][0]}, of_plate{0};
  EXPECT_THROW(finder.let_in(0, of_needle), Error);
  const auto never = [](Index, const Vec3&) { return false; };
  std::vector<Contact> contacts;
  for (const bool is_let_in : {true, false}) {
    finder.begin_step(positions);
    EXPECT_THROW(finder.let_in(mesh.vertex_count(), of_needle), Error);
    EXPECT_THROW(finder.let_in(0, of_plate), Error);
    if (is_let_in) finder.let_in(0, of_needle);
    EXPECT_EQ(finder.choose_ways_off(never).empty(), is_let_in);
    finder.find_contacts(positions, contacts);
    EXPECT_EQ(contacts.empty(), is_let_in);
    std::vector<Vec3> above = positions;
    for (Index v = mesh.vertex_count(); v < std::ssize(above); ++v) above[v][2] += 0.8;
    finder.begin_step(above);
    if (is_let_in) finder.let_in(0, of_needle);
    EXPECT_EQ(finder.find_impacts(positions).pairs.empty(), is_let_in);
  }
}

TEST(WaysOffColliders, PressNoElementThatIsPressedFlat) {
  Pierced pierced{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}, 0.35},
      flat{{-0.03, -0.02, -0.55}, {0.04, 0.05, 0.65}, 0.29};
  EXPECT_EQ(pierced.choose().size(), 1u);
  EXPECT_FALSE(pierced.contacts.empty());
  EXPECT_EQ(pierced.statistics.waiting_points, 0);
  EXPECT_EQ(flat.choose().size(), 1u);
  EXPECT_TRUE(flat.contacts.empty());
  EXPECT_GT(flat.statistics.waiting_points, 0);
}

}  // namespace
}  // namespace selvage
