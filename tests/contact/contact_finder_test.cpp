#include "contact/contact_steps.h"
#include "mesh/simplex_corners.h"
#include "selvage/core/error.h"
#include "selvage/geometry/predicates.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"
#include "solids.h"
#include "test_scale.h"

#include <tbb/global_control.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace selvage {
namespace {

template <typename Mesh>
constexpr bool kTakesMesh = std::is_constructible_v<ContactFinder, Mesh, std::span<const Vec3>, std::span<const Vec3>>;
static_assert(kTakesMesh<const TetMesh&> && kTakesMesh<TetMesh&>);
static_assert(!kTakesMesh<TetMesh> && !kTakesMesh<const TetMesh>, "a temporary would not outlive the finder");

using solids::Solid;
using test::contacts_of_step;
using test::in_mode;
using test::Random;
using test::scaled;
using test::seed;
using Positions = std::vector<Vec3>;

std::int64_t count_of(const ContactFinder& finder, ContactKind kind) {
  return finder.statistics().contacts[static_cast<int>(kind)];
}

std::vector<Contact> contacts_of_step(const Solid& solid, const Positions& t1, ContactOptions options,
                                      const Positions& rest = {}) {
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, rest, solid.positions, {}, options);
  return contacts_of_step(finder, solid.positions, t1);
}

/// A box on the ground, and over it, by the height, a small tetrahedron with its tip down.
Solid tip_over_box(double height) {
  Solid tip = solids::tetrahedron({Vec3{0.5, 0.4, 1}, {0.4, 0.4, 2}, {0.6, 0.4, 2}, {0.5, 0.6, 2}});
  for (Vec3& x : tip.positions) x[2] += height;
  if (orientation(corners_of(tip.elements[0], tip.positions)) < 0) std::swap(tip.elements[0][2], tip.elements[0][3]);
  return solids::together({tip, solids::box({0, 0, 0}, {1, 1, 1}, 1)});
}

Positions moved_down(Positions positions, double by) {
  for (int i = 0; i < 4; ++i) positions[i][2] -= by;
  return positions;
}

TEST(ContactFinder, APenetratingVertexIsSentOutByTheShortestPath) {
  const Solid solid = tip_over_box(-0.125);
  for (const DetectionMode mode : {DetectionMode::kDcd, DetectionMode::kHybrid}) {
    const auto contacts = contacts_of_step(solid, solid.positions, in_mode(mode));
    const auto contact = std::find_if(contacts.begin(), contacts.end(), [](const Contact& c) {
      return c.kind == ContactKind::kVertexPath && c.point_feature == 0;
    });
    ASSERT_NE(contact, contacts.end());
    EXPECT_EQ(contact->vertices[0], 0);
    EXPECT_EQ(contact->weights[0], 1);
    EXPECT_EQ(contact->normal, Vec3(0, 0, 1));
    EXPECT_EQ(contact->point, Vec3(0.5, 0.4, 1));
    EXPECT_EQ(contact->time, 0);
    EXPECT_NEAR(gap_of(*contact, solid.positions), -0.125, 1e-15);
    EXPECT_EQ(std::count_if(contacts.begin(), contacts.end(),
                            [](const Contact& c) { return c.kind >= ContactKind::kVertexFace; }),
              0);
  }
}

TEST(ContactFinder, AFreeVertexThatRunsIntoAFaceMeetsItByCcdAlone) {
  const Solid solid = tip_over_box(0.25);
  const Positions t1 = moved_down(solid.positions, 0.5);
  for (const DetectionMode mode : {DetectionMode::kCcd, DetectionMode::kHybrid}) {
    const auto contacts = contacts_of_step(solid, t1, in_mode(mode));
    ASSERT_FALSE(contacts.empty());
    EXPECT_EQ(contacts[0].kind, ContactKind::kVertexFace);
    EXPECT_EQ(contacts[0].point_feature, 0);
    EXPECT_EQ(contacts[0].normal, Vec3(0, 0, 1));
    EXPECT_NEAR(contacts[0].time, 0.5, 2e-6);
    EXPECT_NEAR(gap_of(contacts[0], t1), -0.25, 1e-12);
    for (const Contact& contact : contacts) EXPECT_GE(contact.kind, ContactKind::kVertexFace);
  }
}

TEST(ContactFinder, ModesSeeWhatTheyAreMeantTo) {
  const Solid inside = tip_over_box(-0.125), outside = tip_over_box(0.25);
  EXPECT_TRUE(contacts_of_step(inside, inside.positions, in_mode(DetectionMode::kOff)).empty());
  EXPECT_TRUE(contacts_of_step(outside, outside.positions, in_mode(DetectionMode::kHybrid)).empty());
  // CCD alone does not find a point that is inside already and stays there.
  const Solid deep = tip_over_box(-0.5);
  const auto by_ccd = contacts_of_step(deep, moved_down(deep.positions, 0.01), in_mode(DetectionMode::kCcd));
  EXPECT_TRUE(std::none_of(by_ccd.begin(), by_ccd.end(), [](const Contact& c) { return c.point_feature == 0; }));
  // DCD alone sees where the step ends, and nothing of what the tip has passed through.
  EXPECT_TRUE(contacts_of_step(outside, moved_down(outside.positions, 5), in_mode(DetectionMode::kDcd)).empty());
  EXPECT_FALSE(contacts_of_step(outside, moved_down(outside.positions, 5), in_mode(DetectionMode::kHybrid)).empty());
}

TEST(ContactFinder, TheHybridAsksWhatWasInsideForAFreshWayOut) {
  const Solid solid = tip_over_box(-0.125);
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions);
  const Positions out = moved_down(solid.positions, -0.5);
  EXPECT_TRUE(contacts_of_step(finder, solid.positions, out).empty()) << "it has left by itself";
  EXPECT_EQ(finder.penetrating_vertices().front(), 0);
  EXPECT_EQ(finder.statistics().penetrating_vertices, std::ssize(finder.penetrating_vertices()));
  EXPECT_EQ(finder.statistics().pose_updates, 2) << "for its start and its end";
  EXPECT_FALSE(contacts_of_step(finder, out, solid.positions).empty()) << "and comes in again, as a free one";
  EXPECT_EQ(count_of(finder, ContactKind::kVertexPath), 0);
  EXPECT_GT(count_of(finder, ContactKind::kVertexFace), 0);
  EXPECT_TRUE(finder.penetrating_vertices().empty());
}

Solid with_positive_elements(Solid solid) {
  for (auto& element : solid.elements)
    if (orientation(corners_of(element, solid.positions)) < 0) std::swap(element[0], element[1]);
  return solid;
}

/// Two tetrahedra, each with an edge that cuts into the other; no vertex is inside.
Solid crossing_edges(double depth) {
  const Vec3 down{0, 0, -depth};
  return solids::together({solids::tetrahedron({Vec3{-1, 0, 0}, {1, 0, 0}, {0, -1, -1}, {0, 1, -1}}),
                           solids::tetrahedron({Vec3{0, -1, 0} + down, Vec3{0, 1, 0} + down, Vec3{1, 0, 1} + down,
                                                Vec3{-1, 0, 1} + down})});
}

TEST(ContactFinder, AnEdgeThroughAnElementHasItsMiddleSentOut) {
  const Solid solid = with_positive_elements(crossing_edges(0.25));
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions, {}, in_mode(DetectionMode::kDcd));
  const auto contacts = contacts_of_step(finder, solid.positions, solid.positions);
  EXPECT_EQ(count_of(finder, ContactKind::kVertexPath), 0);
  ASSERT_EQ(count_of(finder, ContactKind::kEdgePath), 2);
  for (const Contact& contact : contacts) {
    const auto& edge = finder.surface().edges()[contact.point_feature];
    EXPECT_EQ(contact.vertices[0], edge[0]);
    EXPECT_EQ(contact.vertices[1], edge[1]);
    EXPECT_NEAR(contact.weights[0], 0.5, 1e-12);
    EXPECT_NEAR(std::abs(contact.normal[2]), std::sqrt(0.5), 1e-12) << "a face of the ridge";
    EXPECT_NEAR(gap_of(contact, solid.positions), -0.25 * std::sqrt(0.5), 1e-12);
  }
  ContactOptions no_edges = in_mode(DetectionMode::kDcd);
  no_edges.detect_edges = false;
  EXPECT_TRUE(contacts_of_step(solid, solid.positions, no_edges).empty());
}

/// Edge and vertex contacts by DCD alone where nothing moves, in a step of that number.
std::array<std::int64_t, 2> count_ways_out(const Solid& solid, ContactOptions options, std::int64_t step) {
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions, {}, options);
  std::vector<Contact> contacts;
  finder.begin_step(solid.positions, step);
  finder.find_contacts(solid.positions, contacts);
  return {count_of(finder, ContactKind::kEdgePath), count_of(finder, ContactKind::kVertexPath)};
}

/// The same two in one piece, by elements that go from one to the other around the crossing.
Solid crossing_edges_of_one_piece(double depth) {
  Solid solid = crossing_edges(depth);
  for (const Vec3& x : {Vec3{3, 0, -2}, {4, -3, -1}, {4, -3, 1}, {3, 0, 1}}) solid.positions.push_back(x);
  for (const VertexTuple<4>& e : std::initializer_list<VertexTuple<4>>{
           {1, 2, 3, 8}, {1, 2, 8, 9}, {1, 8, 9, 10}, {8, 9, 10, 11}, {9, 10, 11, 6}, {10, 11, 6, 4}, {4, 5, 6, 11}})
    solid.elements.push_back(e);
  return with_positive_elements(solid);
}

TEST(ContactFinder, EdgesInTheirOwnPieceRestInSomeStepsByDcdAlone) {
  IndexedMesh file = make_octopus(1, 0.065, 1);
  apply_pose(file, "swirl");
  const Solid folded = solids::of(file), apart = with_positive_elements(crossing_edges(0.25)),
              crossed = crossing_edges_of_one_piece(0.25);
  const std::vector<Index> piece = crossed.mesh().element_components();
  ASSERT_EQ(std::count(piece.begin(), piece.end(), 0), std::ssize(piece));
  for (const bool interior : {false, true}) {
    ContactOptions dcd = in_mode(interior ? DetectionMode::kHybrid : DetectionMode::kDcd);
    dcd.interior_points = interior;
    const auto [edges, vertices] = count_ways_out(folded, dcd, 0);
    ASSERT_GT(edges, 0);
    ASSERT_GT(vertices, 0);
    const auto two_pieces = count_ways_out(apart, dcd, 0), no_vertex_inside = count_ways_out(crossed, dcd, 0);
    ASSERT_GT(two_pieces[0], 0);
    ASSERT_GT(no_vertex_inside[0], 0);
    ASSERT_EQ(no_vertex_inside[1], 0);
    for (const std::int64_t step : {1, 55, 56, 63, 64, 119, 120, 127, 128}) {
      const bool rest = step % 64 >= 56;
      EXPECT_EQ(count_ways_out(folded, dcd, step), (std::array{rest ? 0 : edges, vertices})) << step;
      EXPECT_EQ(count_ways_out(apart, dcd, step), two_pieces) << step;
      EXPECT_EQ(count_ways_out(crossed, dcd, step), no_vertex_inside) << step;
    }
  }
  const ContactOptions hybrid = in_mode(DetectionMode::kHybrid);
  EXPECT_EQ(count_ways_out(folded, hybrid, 60), count_ways_out(folded, hybrid, 0));
}

TEST(ContactFinder, EdgesThatRunIntoEachOtherMeetByCcd) {
  Solid solid = crossing_edges(-0.25);
  const auto contacts = contacts_of_step(solid, crossing_edges(0.25).positions, {});
  ASSERT_EQ(contacts.size(), 1);
  EXPECT_EQ(contacts[0].kind, ContactKind::kEdgeEdge);
  EXPECT_NEAR(contacts[0].time, 0.5, 2e-6);
  EXPECT_NEAR(std::abs(contacts[0].normal[2]), 1, 1e-12);
  EXPECT_NEAR(gap_of(contacts[0], crossing_edges(0.25).positions), -0.25, 1e-12);
  EXPECT_NEAR(gap_of(contacts[0], solid.positions), 0.25, 1e-12);
  ContactOptions no_edges;
  no_edges.detect_edges = false;
  EXPECT_TRUE(contacts_of_step(solid, crossing_edges(0.25).positions, no_edges).empty());
}

TEST(ContactFinder, UnguardedVerticesAreThoseOfFacesThatMeetAndOfWhatIsInside) {
  for (const double height : {-0.125, -0.5, 0.125}) {
    const Solid solid = tip_over_box(height);
    const TetMesh mesh = solid.mesh();
    ContactFinder finder(mesh, {}, solid.positions);
    finder.begin_step(solid.positions);
    std::vector<Index> expected(finder.penetrating_vertices().begin(), finder.penetrating_vertices().end());
    for (const TrianglePair& pair : SelfCollisionFinder(finder.surface(), solid.positions).find_pairs())
      for (const Index triangle : {pair.first, pair.second})
        for (const Index v : finder.surface().triangles()[triangle]) expected.push_back(v);
    std::sort(expected.begin(), expected.end());
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    EXPECT_EQ(expected.empty(), height > 0);
    EXPECT_EQ(finder.unguarded_vertices(), expected) << height;
    EXPECT_EQ(finder.statistics().unguarded_vertices, static_cast<std::int64_t>(expected.size())) << height;
  }
}

TEST(ContactFinder, UnguardedVerticesAreThoseOfInvertedElementsWhereTheseWait) {
  Solid solid = tip_over_box(0.125);
  solid.positions[0][2] = 3;
  const TetMesh mesh = solid.mesh();
  for (const bool waits : {false, true}) {
    ContactOptions options;
    options.wait_for_inverted = waits;
    ContactFinder finder(mesh, {}, solid.positions, {}, options);
    finder.begin_step(solid.positions);
    EXPECT_EQ(finder.unguarded_vertices(), waits ? (std::vector<Index>{0, 1, 2, 3}) : std::vector<Index>());
  }
}

TEST(ContactFinder, CompleteOverlapsNeedInnerPoints) {
  // One box almost in the place of the other: their surfaces tell little of the volume that they share.
  Solid solid = solids::together({solids::box({0, 0, 0}, {1, 1, 1}, 0.25), solids::box({0, 0, 0}, {1, 1, 1}, 0.25)});
  for (std::size_t v = solid.positions.size() / 2; v < solid.positions.size(); ++v)
    solid.positions[v] += Vec3(0.01, 0.013, 0.007);
  const TetMesh mesh = solid.mesh();
  ContactOptions options;
  options.interior_points = true;
  ContactFinder finder(mesh, {}, solid.positions, {}, options);
  const auto contacts = contacts_of_step(finder, solid.positions, solid.positions);
  EXPECT_GT(count_of(finder, ContactKind::kCentroidPath), mesh.element_count() / 2);
  EXPECT_EQ(count_of(finder, ContactKind::kVertexFace) + count_of(finder, ContactKind::kEdgeEdge), 0);
  std::int64_t inner = 0, outer = 0;
  for (const Contact& contact : contacts) {
    if (contact.kind == ContactKind::kVertexPath)
      ++(mesh.vertex_boundary_faces(contact.point_feature).empty() ? inner : outer);
    double sum = 0;
    for (int i = 0; i < contact.count; ++i) sum += contact.weights[i];
    EXPECT_NEAR(sum, 0, 1e-14);
    EXPECT_LE(gap_of(contact, solid.positions), 1e-14);
    for (int i = 0; i < contact.count; ++i)
      for (int k = 0; k < i; ++k) EXPECT_NE(contact.vertices[i], contact.vertices[k]);
  }
  EXPECT_GT(inner, 0);
  EXPECT_GT(outer, 0);
}

bool same_bits(const Contact& a, const Contact& b) {
  return a.kind == b.kind && a.count == b.count && a.vertices == b.vertices && a.point_feature == b.point_feature &&
         a.surface_feature == b.surface_feature &&
         std::memcmp(a.weights.data(), b.weights.data(), sizeof a.weights) == 0 &&
         std::memcmp(a.normal.data(), b.normal.data(), sizeof(double) * 3) == 0 &&
         std::memcmp(a.point.data(), b.point.data(), sizeof(double) * 3) == 0 && a.time == b.time;
}

TEST(ContactFinder, GivesTheSameBitsForAnyNumberOfThreads) {
  IndexedMesh file = make_octopus(1, 0.065, 1);
  apply_pose(file, "swirl");
  const Solid solid = solids::of(file);
  const TetMesh mesh = solid.mesh();
  for (const bool interior : {false, true}) {
    std::vector<std::vector<Contact>> first;
    for (const int threads : {1, 2, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      ContactOptions options;
      options.interior_points = interior;
      ContactFinder finder(mesh, {}, solid.positions, {}, options);
      Positions t0 = solid.positions;
      Random random(seed(7));
      for (std::size_t step = 0; step < static_cast<std::size_t>(scaled(3)); ++step) {
        Positions t1 = t0;
        for (Vec3& x : t1) x += random.vector(0.01);
        const auto contacts = contacts_of_step(finder, t0, t1);
        EXPECT_GT(contacts.size(), 0);
        if (threads == 1) first.push_back(contacts);
        ASSERT_EQ(contacts.size(), first[step].size());
        EXPECT_TRUE(std::equal(contacts.begin(), contacts.end(), first[step].begin(), same_bits));
        t0 = t1;
      }
    }
  }
}

TEST(ContactFinder, StatisticsAddUp) {
  const Solid solid =
      solids::together({solids::box({0, 0, 0}, {1, 1, 1}, 0.3), solids::box({0.8, 0.1, 0.1}, {2, 1.1, 1.1}, 0.3)});
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions);
  Positions t1 = solid.positions;
  for (Vec3& x : t1) x[0] *= 0.99;
  const auto contacts = contacts_of_step(finder, solid.positions, t1);
  const ContactStatistics& statistics = finder.statistics();
  std::int64_t sum = 0;
  for (const std::int64_t count : statistics.contacts) sum += count;
  EXPECT_EQ(sum, std::ssize(contacts));
  EXPECT_GT(statistics.penetrating_vertices, 0);
  EXPECT_GT(statistics.penetrating_edges, 0);
  EXPECT_GT(statistics.path_queries, 0);
  EXPECT_EQ(statistics.pose_updates, 2);
  EXPECT_GT(statistics.paths.volumes_visited, 0);
  EXPECT_GT(statistics.penetrations.elements_tested, 0);
  EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) {
    return std::pair(a.kind, a.point_feature) < std::pair(b.kind, b.point_feature);
  }));
  contacts_of_step(finder, t1, t1);
  EXPECT_LE(finder.statistics().pose_updates, 2) << "of this step alone";
}

/// A corner of a box in the place of other vertices flattens and inverts elements. Their edges and centroids are
/// then inside others, and some end their way out where they are: on a face, by the same weights of the same vertices.
TEST(ContactFinder, GivesNoContactWithoutVertices) {
  const Solid solid = solids::box({0, 0, 0}, {1, 1, 1}, 0.5);
  const TetMesh mesh = solid.mesh();
  for (const Vec3& place : {Vec3(0, 0, 0.5), Vec3(0, 0.5, 0), Vec3(-0.5, 0.5, -0.25)}) {
    Positions t1 = solid.positions;
    ASSERT_EQ(t1[0], Vec3::Zero());
    t1[0] = place;
    for (const bool waits : {false, true}) {
      ContactOptions options = in_mode(DetectionMode::kDcd);
      options.interior_points = true;
      options.wait_for_inverted = waits;
      ContactFinder finder(mesh, {}, solid.positions, {}, options);
      const std::vector<Contact> contacts = contacts_of_step(finder, t1, t1);
      EXPECT_FALSE(contacts.empty());
      for (const Contact& contact : contacts) EXPECT_GE(contact.count, 2) << contact.point_feature;
    }
  }
}

TEST(ContactFinder, RefusesWhatDoesNotFit) {
  const Solid solid = tip_over_box(0.1);
  const TetMesh mesh = solid.mesh();
  Positions short_one(solid.positions.begin(), solid.positions.end() - 1), broken = solid.positions;
  broken[3][1] = std::nan("");
  EXPECT_THROW(ContactFinder(mesh, {}, short_one), Error);
  EXPECT_THROW(ContactFinder(mesh, {}, broken), Error);
  const std::vector<Index> few_objects{0, 1};
  EXPECT_THROW(ContactFinder(mesh, {}, solid.positions, few_objects), Error);
  ContactOptions rest;
  rest.rule = ClosestPointRule::kRestPose;
  EXPECT_THROW(ContactFinder(mesh, {}, solid.positions, {}, rest), Error);
  EXPECT_THROW(ContactFinder(mesh, short_one, solid.positions), Error);
  ContactFinder finder(mesh, {}, solid.positions);
  std::vector<Contact> contacts;
  EXPECT_THROW(finder.find_contacts(solid.positions, contacts), Error) << "no step has begun";
  EXPECT_THROW(finder.begin_step(broken), Error);
  EXPECT_THROW(finder.find_contacts(short_one, contacts), Error);
}

}  // namespace
}  // namespace selvage
