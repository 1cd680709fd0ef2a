#include "contact/tangles.h"

#include "mesh/simplex_corners.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/geometry/predicates.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace selvage {
namespace {

using Numbers = std::vector<Index>;

/// Elements of four vertices each, every one a piece, but the first two, which have a face in common.
struct Scraps {
  TetMesh mesh{17, {{0, 1, 2, 3}, {1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}, {13, 14, 15, 16}}};
  std::vector<Vec3> positions = std::vector<Vec3>(17, Vec3::Zero());
  std::vector<PenetratingPoint> points;

  void add_vertex(Index v, Index element) { points.push_back(penetrating_vertex(v, element, positions)); }
  void add_edge(Index a, Index b, Index element) {
    points.push_back(penetrating_edge(0, {a, b}, 0.5, element, positions));
  }
  Numbers number(bool by_piece = true) {
    const Numbers pieces = mesh.element_components();
    const Index count = number_tangles(mesh, by_piece ? std::span(pieces) : std::span<const Index>(), points);
    Numbers tangles;
    for (const PenetratingPoint& p : points) tangles.push_back(p.tangle);
    EXPECT_EQ(count, std::ssize(std::set<Index>(tangles.begin(), tangles.end())));
    return tangles;
  }
};

TEST(Tangles, HangTogetherByVerticesInsideTheirOwnPiece) {
  Scraps scraps;
  scraps.add_edge(0, 1, 1);
  scraps.add_edge(2, 3, 0);
  scraps.add_vertex(4, 0);
  EXPECT_EQ(scraps.number(), (Numbers{0, 1, 2}));
  scraps.add_edge(3, 4, 0);
  EXPECT_EQ(scraps.number(), (Numbers{0, 1, 1, 1})) << "it joins two";
  scraps.add_edge(1, 4, 1);
  EXPECT_EQ(scraps.number(), (Numbers{0, 0, 0, 0, 0})) << "it joins all";
}

TEST(Tangles, AreOnePointEachInOtherPieces) {
  Scraps scraps;
  scraps.add_edge(0, 1, 2);
  scraps.add_edge(1, 2, 2);
  scraps.add_edge(1, 3, 0);
  scraps.add_vertex(1, 1);
  scraps.add_vertex(1, 3);
  EXPECT_EQ(scraps.number(), (Numbers{0, 1, 2, 2, 3}));
  EXPECT_EQ(scraps.number(false), (Numbers{0, 1, 2, 3, 4})) << "as every point, where no pieces are told";
}

bool any_inverted(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Index> vertices) {
  return std::any_of(vertices.begin(), vertices.end(), [&](Index v) {
    const auto around = mesh.vertex_elements(v);
    return std::any_of(around.begin(), around.end(),
                       [&](Index e) { return orientation(corners_of(mesh.elements()[e], positions)) < 0; });
  });
}

/// Of a boundary vertex or edge that is inside: an end of an edge that has no weight is not in the contact. Nor is one
/// that the face has, too, with the same weight; that counts.
bool has_inverted_point(const TetMesh& mesh, std::span<const Vec3> positions, const TriangleMesh& surface,
                        const Contact& contact) {
  std::vector<Index> point{contact.point_feature};
  if (contact.kind == ContactKind::kEdgePath) {
    const auto& ends = surface.edges()[contact.point_feature];
    point.assign(ends.begin(), ends.end());
  }
  const auto end = contact.vertices.begin() + contact.count;
  const auto& face = mesh.boundary_faces()[contact.surface_feature];
  std::erase_if(point, [&](Index v) {
    return std::find(contact.vertices.begin(), end, v) == end && std::find(face.begin(), face.end(), v) == face.end();
  });
  return any_inverted(mesh, positions, point);
}

bool has_inverted_surface(const TetMesh& mesh, std::span<const Vec3> positions, const Contact& contact) {
  return any_inverted(mesh, positions, mesh.boundary_faces()[contact.surface_feature]);
}

std::vector<Contact> contacts_of_step(const TetMesh& mesh, std::span<const Vec3> t0, std::span<const Vec3> t1,
                                      ContactOptions options) {
  ContactFinder finder(mesh, {}, t0, {}, options);
  std::vector<Contact> contacts;
  finder.begin_step(t0);
  finder.find_contacts(t1, contacts);
  return contacts;
}

class Waiting : public testing::TestWithParam<solids::Family> {};

// All whose point is at a vertex of an inverted element, and no others, at whichever end of the step others are
// inverted.
TEST_P(Waiting, ContactsAreThoseOfInvertedElementsWithoutTangles) {
  for (const solids::Motion& motion : solids::motions()) {
    test::Random random(test::seed(9));
    solids::Solid solid = GetParam().make(random);
    const TetMesh mesh = solid.mesh();
    const TriangleMesh surface = boundary_surface(mesh);
    ContactOptions options;
    options.mode = DetectionMode::kDcd;
    for (int step = 0; step < 2; ++step) {
      const std::vector<Vec3> start = solid.positions;
      motion.move(solid.positions, random);
      options.wait_for_inverted = false;
      std::vector<Contact> right = contacts_of_step(mesh, start, solid.positions, options);
      std::erase_if(right, [&](const Contact& c) { return has_inverted_point(mesh, start, surface, c); });
      options.wait_for_inverted = true;
      const std::vector<Contact> kept = contacts_of_step(mesh, start, solid.positions, options);
      ASSERT_EQ(kept.size(), right.size()) << motion.name;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        EXPECT_EQ(kept[i].point_feature, right[i].point_feature) << motion.name;
        EXPECT_EQ(kept[i].surface_feature, right[i].surface_feature) << motion.name;
        EXPECT_EQ(kept[i].weights, right[i].weights) << motion.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, Waiting, testing::ValuesIn(solids::families()),
                         [](const auto& family) { return family.param.name; });

/// A rod that crosses itself twice.
IndexedMesh make_knotted_rod() {
  ShapeOptions options;
  options.length = 8;
  options.radius = 0.2;
  IndexedMesh rod = make_shape("rod", options);
  pose_self_crossing(rod.positions, 0, 2);
  return rod;
}

class WaitingTangles : public testing::TestWithParam<DetectionMode> {
 protected:
  std::vector<Contact> find(bool wait) {
    ContactOptions options;
    options.mode = GetParam();
    options.wait_for_inverted = wait;
    ContactFinder finder(mesh, {}, rod.positions, {}, options);
    std::vector<Contact> contacts;
    finder.begin_step(rod.positions);
    finder.find_contacts(rod.positions, contacts);
    statistics = finder.statistics();
    std::erase_if(contacts, [](const Contact& c) { return c.kind > ContactKind::kCentroidPath; });
    return contacts;
  }

  /// Mirrors a vertex to beyond the opposite face of one of its elements.
  void turn_element_of(Index vertex) {
    const auto& element = mesh.elements()[mesh.vertex_elements(vertex).front()];
    Vec3 sum = Vec3::Zero();
    for (const Index v : element) sum += v == vertex ? Vec3(Vec3::Zero()) : rod.positions[v];
    rod.positions[vertex] += 1.1 * (sum / 3 - rod.positions[vertex]);
  }

  bool has_inverted_point(const Contact& contact) const {
    return selvage::has_inverted_point(mesh, rod.positions, surface, contact);
  }

  IndexedMesh rod = make_knotted_rod();
  TetMesh mesh{static_cast<Index>(rod.positions.size()), rod.tetrahedra};
  TriangleMesh surface = boundary_surface(mesh);
  ContactStatistics statistics;
};

TEST_P(WaitingTangles, AreThoseWithAnInvertedElement) {
  const std::vector<Contact> before = find(true);
  ASSERT_FALSE(before.empty());
  EXPECT_EQ(statistics.waiting_points, 0) << "nothing is inverted";
  turn_element_of(before.front().point_feature);
  const std::vector<Contact> all = find(false), kept = find(true);
  EXPECT_GT(statistics.waiting_points, 0);
  EXPECT_GE(statistics.path_queries + statistics.waiting_points, std::ssize(all));
  EXPECT_TRUE(std::none_of(kept.begin(), kept.end(), [&](const Contact& c) { return has_inverted_point(c); }));
  EXPECT_FALSE(kept.empty()) << "the other crossing";
  std::size_t next = 0, left_out = 0, for_others = 0;
  for (const Contact& contact : all) {
    if (next < kept.size() && kept[next].kind == contact.kind && kept[next].point_feature == contact.point_feature &&
        kept[next].surface_feature == contact.surface_feature) {
      EXPECT_EQ(kept[next++].weights, contact.weights);
      continue;
    }
    ++left_out;
    for_others += !has_inverted_point(contact);
  }
  EXPECT_EQ(next, kept.size()) << "contacts that are none without waiting";
  EXPECT_GT(left_out, 0);
  EXPECT_EQ(for_others > 0, GetParam() == DetectionMode::kHybrid) << "whole tangles, or each contact for itself";
}

// The face by which a point is to leave is at an inverted element, the point is not.
TEST_P(WaitingTangles, LeaveByFacesAtInvertedElementsWhereAllIsFoundByDcd) {
  const Contact contact = find(true).front();
  turn_element_of(mesh.boundary_faces()[contact.surface_feature][0]);
  const std::vector<Contact> all = find(false), kept = find(true);
  const auto leaves_there = [&](const Contact& c) {
    return has_inverted_surface(mesh, rod.positions, c) && !has_inverted_point(c);
  };
  const auto count = std::count_if(all.begin(), all.end(), leaves_there);
  EXPECT_GT(count, 0);
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(), leaves_there), GetParam() == DetectionMode::kDcd ? count : 0);
}

INSTANTIATE_TEST_SUITE_P(Modes, WaitingTangles, testing::Values(DetectionMode::kDcd, DetectionMode::kHybrid),
                         [](const auto& mode) { return mode.param == DetectionMode::kDcd ? "Dcd" : "Hybrid"; });

}  // namespace
}  // namespace selvage
