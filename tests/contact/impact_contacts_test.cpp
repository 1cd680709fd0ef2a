#include "contact/impacts/impact_contacts.h"

#include "mesh/simplex_corners.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/distance.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace selvage {
namespace {

using test::Random;
using Positions = std::vector<Vec3>;

/// A triangle on the ground that looks up (0, 1, 2), and one whose vertex 3 is the point.
const TriangleMesh kGroundAndPoint(6, {{0, 1, 2}, {3, 4, 5}});
const Positions kStart{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 2, 9}, {2, 1, 9}};

Positions with_point(const Vec3& x) {
  Positions positions = kStart;
  positions[3] = x;
  return positions;
}

std::optional<Contact> ground_contact(const Positions& t0, const Positions& t1, double time) {
  return vertex_face_contact({kGroundAndPoint, t0, t1}, {3, 0}, time);
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-12) {
  EXPECT_LE((a - b).norm(), tolerance) << a.transpose() << " is not " << b.transpose();
}

TEST(VertexFaceContact, OfAFallingVertexPointsUp) {
  const auto contact = ground_contact(kStart, with_point({1, 1, -1}), 0.5);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->kind, ContactKind::kVertexFace);
  EXPECT_EQ(contact->count, 4);
  EXPECT_EQ(contact->vertices[0], 3);
  EXPECT_EQ(contact->point_feature, 3);
  EXPECT_EQ(contact->surface_feature, 0);
  EXPECT_EQ(contact->time, 0.5);
  expect_near(contact->normal, {0, 0, 1});
  expect_near(contact->point, {1, 1, 0});
  EXPECT_EQ(contact->weights[0], 1);
  EXPECT_NEAR(contact->weights[1], -0.5, 1e-12);
  EXPECT_NEAR(contact->weights[2], -0.25, 1e-12);
  EXPECT_NEAR(contact->weights[3], -0.25, 1e-12);
  EXPECT_NEAR(gap_of(*contact, with_point({1, 1, -1})), -1, 1e-12);
}

TEST(VertexFaceContact, OfARisingVertexPointsDown) {
  Positions t0 = with_point({1, 1, -1}), t1 = with_point({1, 1, 1});
  for (Positions* x : {&t0, &t1}) (*x)[4][2] = (*x)[5][2] = -9;
  const auto contact = ground_contact(t0, t1, 0.5);
  ASSERT_TRUE(contact);
  expect_near(contact->normal, {0, 0, -1});
}

TEST(VertexFaceContact, AFaceThatRisesToARestingVertexPointsUp) {
  Positions t1 = kStart;
  for (int i = 0; i < 3; ++i) t1[i][2] += 2;
  const auto contact = ground_contact(kStart, t1, 0.5);
  ASSERT_TRUE(contact);
  expect_near(contact->normal, {0, 0, 1});
}

TEST(VertexFaceContact, PointsOutwardWhereTheyTouchAtTheStartOrGraze) {
  const auto leaving = ground_contact(with_point({1, 1, 0}), with_point({1, 1, -1}), 0);
  ASSERT_TRUE(leaving);
  expect_near(leaving->normal, {0, 0, 1});
  const auto gliding = ground_contact(with_point({-1, 1, 0}), with_point({1, 1, 0}), 0.5);
  ASSERT_TRUE(gliding);
  expect_near(gliding->normal, {0, 0, 1});
}

TEST(VertexFaceContact, OfAFlatFacePointsToWhereTheVertexStarted) {
  Positions t0 = kStart, t1 = with_point({1, 0, -1});
  t0[3] = {1, 0, 1};
  for (Positions* x : {&t0, &t1}) (*x)[2] = {2, 0, 0};
  const auto contact = ground_contact(t0, t1, 0.5);
  ASSERT_TRUE(contact);
  expect_near(contact->normal, {0, 0, 1});
  t0[3] = {1, 0, 0};
  t1[3] = {1, 0, 0};
  EXPECT_FALSE(ground_contact(t0, t1, 0));
}

/// A pyramid that looks up, of any height, and the side of a body: that looks along x, and slides that way while it is
/// pressed down a little.
struct Slide {
  TriangleMesh mesh{8, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}, {5, 6, 7}}};
  Positions t0, t1;

  explicit Slide(double height)
      : t0{{0, 0, height}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {-1, -1, -0.1}, {-1, 1, -0.1}, {-1, 0, 1}},
        t1(t0) {
    for (Positions* x : {&t0, &t1})
      for (int i : {5, 6, 7}) (*x)[i][2] += height;
    for (int i : {5, 6, 7}) t1[i] += Vec3(2, 0, -0.05);
  }
  std::optional<Contact> contact() const { return vertex_face_contact({mesh, t0, t1}, {0, 4}, 0.5); }
};

TEST(VertexFaceContact, LiftsOffAFlatWhatSlidesOnItALittleTooLow) {
  const auto contact = Slide(0).contact();
  ASSERT_TRUE(contact);
  expect_near(contact->normal, {0, 0, -1});
  EXPECT_NEAR(gap_of(*contact, Slide(0).t1), -0.025, 1e-12);
}

TEST(VertexFaceContact, OfATipStaysAcrossTheFaceHoweverSteepItsSidesAre) {
  for (const double height : {0.2, 1.0, 9.0}) {
    Slide fall(height);
    // The ground comes down on the tip.
    const std::array<Vec3, 3> ground{Vec3{-1, -1, 0}, Vec3{-1, 1, 0}, Vec3{2, 0, 0}};
    for (int i = 0; i < 3; ++i) {
      fall.t0[5 + i] = ground[i] + Vec3(0, 0, height + 1);
      fall.t1[5 + i] = ground[i] + Vec3(0.5, 0, height - 1);
    }
    const auto contact = fall.contact();
    ASSERT_TRUE(contact);
    expect_near(contact->normal, {0, 0, -1});
  }
}

/// Edges (0, 1) along x and (2, 3) along y, each with a triangle that looks away from the other.
struct TwoEdges {
  TriangleMesh mesh{6, {{0, 1, 4}, {2, 3, 5}}};
  Positions t0{{-1, 0, 1}, {1, 0, 1}, {0, -1, 0}, {0, 1, 0}, {0, 1, 2}, {1, 0, -1}}, t1 = t0;
  Index first = 0, second = 0;

  TwoEdges() {
    for (Index e = 0; e < mesh.edge_count(); ++e) {
      if (mesh.edges()[e] == VertexTuple<2>{0, 1}) first = e;
      if (mesh.edges()[e] == VertexTuple<2>{2, 3}) second = e;
    }
  }
  std::optional<Contact> contact(double time) const {
    return edge_edge_contact({mesh, t0, t1}, {std::min(first, second), std::max(first, second)}, time);
  }
};

TEST(EdgeEdgeContact, PointsToTheSideThatTheFirstComesFrom) {
  TwoEdges edges;
  edges.t1[0][2] = edges.t1[1][2] = -1;
  const auto contact = edges.contact(0.5);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->kind, ContactKind::kEdgeEdge);
  EXPECT_EQ(contact->count, 4);
  expect_near(contact->normal, {0, 0, 1});
  expect_near(contact->point, {0, 0, 0});
  const std::array<Index, 7> vertices{0, 1, 2, 3, 0, 0, 0};
  EXPECT_EQ(contact->vertices, vertices);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(contact->weights[i], i < 2 ? 0.5 : -0.5, 1e-12);
  EXPECT_NEAR(gap_of(*contact, edges.t1), -1, 1e-12);

  TwoEdges from_below;
  from_below.t0[0][2] = from_below.t0[1][2] = -1;
  for (Positions* x : {&from_below.t0, &from_below.t1}) std::swap((*x)[4][2], (*x)[5][2]);
  const auto below = from_below.contact(0.5);
  ASSERT_TRUE(below);
  expect_near(below->normal, {0, 0, -1});
}

TEST(EdgeEdgeContact, LiftsOffAFlatWhatSlidesOnItALittleTooLow) {
  // The flat has the edge (0, 1); the upright edge (4, 5) of a body runs into it along x.
  const TriangleMesh mesh(8, {{1, 0, 2}, {0, 1, 3}, {4, 5, 6}, {5, 4, 7}});
  const Positions t0{{0, 1, 0},     {0, -1, 0},   {-1, 0, 0},   {1, 0, 0},
                     {-1, 0, -0.1}, {-1, 0, 0.9}, {-2, 1, 0.1}, {-2, -1, 0.1}};
  Positions t1 = t0;
  for (int i : {4, 5, 6, 7}) t1[i] += Vec3(2, 0, -0.05);
  const auto number = [&](VertexTuple<2> edge) {
    return static_cast<Index>(std::find(mesh.edges().begin(), mesh.edges().end(), edge) - mesh.edges().begin());
  };
  const Index flat = number({0, 1}), upright = number({4, 5});
  for (const EdgeEdgePair pair : {EdgeEdgePair{flat, upright}, EdgeEdgePair{upright, flat}}) {
    const auto contact = edge_edge_contact({mesh, t0, t1}, pair, 0.5);
    ASSERT_TRUE(contact);
    expect_near(contact->normal, {0, 0, pair.first == upright ? 1.0 : -1.0});
    EXPECT_NEAR(gap_of(*contact, t1), -0.025, 1e-12);
  }
}

TEST(EdgeEdgeContact, OfParallelEdgesPointsFromTheOneToTheOther) {
  TwoEdges edges;
  edges.t0[2] = edges.t1[2] = {-1, 0, 0};
  edges.t0[3] = edges.t1[3] = {2, 0, 0};
  edges.t1[0][2] = edges.t1[1][2] = -1;
  const auto contact = edges.contact(0.5);
  ASSERT_TRUE(contact);
  expect_near(contact->normal, {0, 0, 1});
  for (int i : {0, 1}) edges.t0[i][2] = edges.t1[i][2] = 0;
  EXPECT_FALSE(edges.contact(0));
}

TEST(EdgeEdgeContact, OfEdgesThatTouchPointsFromOuterSideToOuterSide) {
  TwoEdges edges;
  for (int i : {0, 1}) edges.t0[i][2] = edges.t1[i][2] = 0;
  // Area normals: the first's triangle looks along -y + z..., the second's along x - z...
  const Vec3 first = area_normal({edges.t0[0], edges.t0[1], edges.t0[4]});
  const Vec3 second = area_normal({edges.t0[2], edges.t0[3], edges.t0[5]});
  const auto contact = edges.contact(0);
  ASSERT_TRUE(contact);
  EXPECT_NEAR(std::abs(contact->normal[2]), 1, 1e-12);
  EXPECT_GE(contact->normal.dot(second - first), 0);
}

/// A vertex, or an edge's first end, and three other points with random motions, of which many meet.
MovingPoints random_motion(Random& random) {
  MovingPoints points;
  for (int i = 0; i < 4; ++i) {
    points.t0[i] = random.vector(1);
    points.t1[i] = random.vector(1);
  }
  return points;
}

TEST(ImpactContacts, MeetAtTheTimeOfImpactAndComeFromTheSideOfTheNormal) {
  const TriangleMesh face(4, {{1, 2, 3}});
  const TriangleMesh edges(6, {{0, 1, 4}, {2, 3, 5}});
  Random random(test::seed(1));
  int vertex_faces = 0, edge_edges = 0;
  for (std::int64_t n = 0; n < test::scaled(20000); ++n) {
    const MovingPoints points = random_motion(random);
    Positions t0(points.t0.begin(), points.t0.end()), t1(points.t1.begin(), points.t1.end());
    const auto check = [&](const Contact& contact, double time) {
      Positions before(t0.size()), at(t0.size());
      for (std::size_t i = 0; i < t0.size(); ++i) {
        const double earlier = std::max(0.0, time - 1e-4);
        before[i] = (1 - earlier) * t0[i] + earlier * t1[i];
        at[i] = (1 - time) * t0[i] + time * t1[i];
      }
      EXPECT_LE(offset_of(contact, at).norm(), 1e-5);
      EXPECT_NEAR(contact.normal.norm(), 1, 1e-12);
      double sum = 0;
      for (int i = 0; i < contact.count; ++i) sum += contact.weights[i];
      EXPECT_NEAR(sum, 0, 1e-14);
      // Grazing motions come from neither side.
      if (time > 1e-3 && std::abs(gap_of(contact, before)) > 1e-5) {
        EXPECT_GT(gap_of(contact, before), 0);
      }
    };
    if (const auto time = vertex_face_impact(points)) {
      const auto contact = vertex_face_contact({face, t0, t1}, {0, 0}, *time);
      ASSERT_TRUE(contact);
      check(*contact, *time);
      ++vertex_faces;
    }
    if (const auto time = edge_edge_impact(points)) {
      for (Positions* x : {&t0, &t1}) x->insert(x->end(), {random.vector(1), random.vector(1)});
      const Index first = 0, second = 3;
      ASSERT_EQ(edges.edges()[first], (VertexTuple<2>{0, 1}));
      ASSERT_EQ(edges.edges()[second], (VertexTuple<2>{2, 3}));
      const auto contact = edge_edge_contact({edges, t0, t1}, {first, second}, *time);
      ASSERT_TRUE(contact);
      check(*contact, *time);
      ++edge_edges;
    }
  }
  EXPECT_GT(vertex_faces, 0);
  EXPECT_GT(edge_edges, 0);
}

TEST(ClosestPlaces, AreAsFarApartAsTheSegments) {
  Random random(test::seed(2));
  for (std::int64_t n = 0; n < test::scaled(10000); ++n) {
    std::array<Vec3, 2> a{random.vector(1), random.vector(1)}, b{random.vector(1), random.vector(1)};
    if (n % 4 == 1) a[1] = a[0];
    if (n % 4 == 2) b[1] = b[0];
    if (n % 8 == 3) b[1] = b[0] + 0.7 * (a[1] - a[0]);
    if (n % 16 == 5) b[1] = b[0], a[1] = a[0];
    const auto [s, t] = closest_places(a, b);
    ASSERT_GE(std::min(s, t), 0);
    ASSERT_LE(std::max(s, t), 1);
    const double distance = (a[0] + s * (a[1] - a[0]) - b[0] - t * (b[1] - b[0])).norm();
    EXPECT_NEAR(distance, std::sqrt(squared_distance(a, b)), 1e-9);
  }
}

TEST(FirstImpacts, KeepTheEarliestOfEachVertex) {
  const std::vector<VertexFacePair> pairs{{1, 0}, {1, 4}, {1, 7}, {2, 3}, {5, 1}, {5, 2}};
  const std::vector<double> times{0.5, 0.25, 0.25, 0.9, 0.1, 0.2};
  EXPECT_EQ(first_impacts(pairs, times), (std::vector<Index>{1, 3, 4}));
  EXPECT_TRUE(first_impacts(std::span<const VertexFacePair>(), {}).empty());
}

TEST(FirstImpacts, KeepPairsThatAreTheEarliestOfOneOfTheirEdges) {
  const std::vector<EdgeEdgePair> pairs{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}};
  const std::vector<double> times{0.5, 0.1, 0.2, 0.9, 0.8};
  // 0: (0,2); 1: (1,2); 2: (0,2); 3: (2,3).
  EXPECT_EQ(first_impacts(pairs, times, 4), (std::vector<Index>{1, 2, 4}));
}

}  // namespace
}  // namespace selvage
