// ContactOptions::take_turns.
#include "contact/contact_steps.h"
#include "selvage/mesh/triangle_mesh.h"
#include "solids.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

namespace selvage {
namespace {

using solids::Solid;
using test::contacts_of_step;

constexpr int kTurns = 3;

/// Two boxes of a metre, the second moved by some way.
Solid two_boxes(const Vec3& way) {
  const Vec3 lower(0.011, 0.007, 0.003);
  return solids::together(
      {solids::box({0, 0, 0}, {1, 1, 1}, 0.1), solids::box(lower + way, lower + way + Vec3::Ones(), 0.1)});
}

/// One step of each body: all moves by little, to all sides.
std::vector<Vec3> end_of_step(const Solid& solid) {
  std::vector<Vec3> positions = solid.positions;
  for (std::size_t v = 0; v < positions.size(); ++v)
    positions[v] += 0.06 * Vec3(std::sin(3.0 * v), std::sin(5.0 * v), std::sin(7.0 * v));
  return positions;
}

struct Found {
  std::vector<Contact> contacts;
  ContactStatistics statistics;

  std::set<Index> features(ContactKind kind) const {
    std::set<Index> found;
    for (const Contact& c : contacts)
      if (c.kind == kind) found.insert(c.point_feature);
    return found;
  }
};

Found find(const TetMesh& mesh, const Solid& solid, bool takes_turns, std::int64_t step) {
  ContactOptions options;
  options.take_turns = takes_turns;
  ContactFinder finder(mesh, {}, solid.positions, {}, options);
  Found found;
  finder.begin_step(solid.positions, step);
  finder.find_contacts(end_of_step(solid), found.contacts);
  found.statistics = finder.statistics();
  return found;
}

bool is_impact(const Contact& c) {
  return c.kind == ContactKind::kVertexFace || c.kind == ContactKind::kEdgeEdge;
}

TEST(Turns, DeepVerticesHaveOneEachAndTheirEdgesNone) {
  const Solid solid = two_boxes({0.2, 0.2, 0.3});
  const TetMesh mesh = solid.mesh();
  const TriangleMesh surface = boundary_surface(mesh);
  const Found all = find(mesh, solid, false, 0);
  const std::set<Index> vertices = all.features(ContactKind::kVertexPath), edges = all.features(ContactKind::kEdgePath);
  ASSERT_GT(10 * vertices.size(), mesh.boundary_vertices().size());
  ASSERT_EQ(all.statistics.off_turn, 0);

  // The start of the step says what is deep: each moves, so those inside at its end differ.
  std::set<Index> inside;
  {
    ContactFinder finder(mesh, {}, solid.positions);
    finder.begin_step(solid.positions);
    for (const Index v : finder.penetrating_vertices()) inside.insert(v);
  }
  const auto is_deep = [&](Index v) {
    for (const Index t : surface.vertex_triangles(v))
      for (const Index w : surface.triangles()[t])
        if (!inside.contains(w)) return false;
    return true;
  };

  std::map<Index, int> turns;
  for (int step = 0; step < kTurns; ++step) {
    const Found some = find(mesh, solid, true, step);
    EXPECT_GT(some.statistics.off_turn, 0);
    EXPECT_EQ(some.statistics.penetrating_vertices, all.statistics.penetrating_vertices);
    EXPECT_EQ(some.statistics.penetrating_edges, all.statistics.penetrating_edges);
    EXPECT_EQ(some.statistics.unguarded_vertices, all.statistics.unguarded_vertices);
    for (const Index v : some.features(ContactKind::kVertexPath)) ++turns[v];
    for (const Index e : edges) {
      const auto& [a, b] = surface.edges()[e];
      EXPECT_EQ(some.features(ContactKind::kEdgePath).contains(e), !(inside.contains(a) && inside.contains(b)));
    }
    EXPECT_EQ(std::count_if(some.contacts.begin(), some.contacts.end(), is_impact),
              std::count_if(all.contacts.begin(), all.contacts.end(), is_impact));
  }
  int deep = 0;
  for (const Index v : vertices) {
    EXPECT_EQ(turns[v], is_deep(v) ? 1 : kTurns) << "vertex " << v;
    deep += is_deep(v);
  }
  EXPECT_GT(deep, 50);
  EXPECT_EQ(turns.size(), vertices.size());
}

TEST(Turns, AllHaveOneInEachStepWhereFewAreInside) {
  const Solid solid = two_boxes({0.75, 0.75, 0.75});
  const TetMesh mesh = solid.mesh();
  const Found all = find(mesh, solid, false, 0), some = find(mesh, solid, true, 0);
  ASSERT_GT(all.statistics.penetrating_vertices, 20);
  ASSERT_LT(10 * all.statistics.penetrating_vertices, std::ssize(mesh.boundary_vertices()));
  EXPECT_EQ(some.statistics.off_turn, 0);
  ASSERT_EQ(some.contacts.size(), all.contacts.size());
  for (std::size_t i = 0; i < all.contacts.size(); ++i) {
    EXPECT_EQ(some.contacts[i].kind, all.contacts[i].kind);
    EXPECT_EQ(some.contacts[i].point_feature, all.contacts[i].point_feature);
    EXPECT_EQ(some.contacts[i].normal, all.contacts[i].normal);
  }
}

}  // namespace
}  // namespace selvage
