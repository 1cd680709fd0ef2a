#include "contact/contact_steps.h"
#include "mesh/simplex_corners.h"
#include "selvage/geometry/continuous.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace selvage {
namespace {

using solids::Solid;
using test::contacts_of_step;
using test::in_mode;
using test::Random;
using test::scaled;
using test::seed;
using Positions = std::vector<Vec3>;

class ContactFinderOf : public testing::TestWithParam<solids::Family> {};

void keep_least(std::map<Index, double>& least, Index i, double value) {
  const auto [place, is_new] = least.try_emplace(i, value);
  place->second = std::min(place->second, value);
}

/// All pairs of the boundary, decided and timed one by one.
std::map<Index, double> first_times_of_vertices(const ContactFinder& finder, const Positions& t0, const Positions& t1) {
  std::map<Index, double> first;
  const TriangleMesh& surface = finder.surface();
  for (Index v = 0; v < surface.vertex_count(); ++v)
    for (const auto& face : surface.triangles()) {
      if (surface.vertex_triangles(v).empty() || share_vertex(std::array{v}, face)) continue;
      MovingPoints points{{t0[v], t0[face[0]], t0[face[1]], t0[face[2]]},
                          {t1[v], t1[face[0]], t1[face[1]], t1[face[2]]}};
      if (const auto time = vertex_face_impact(points)) keep_least(first, v, *time);
    }
  return first;
}

std::map<std::pair<Index, Index>, double> times_of_edges(const ContactFinder& finder, const Positions& t0,
                                                         const Positions& t1) {
  std::map<std::pair<Index, Index>, double> all;
  const auto edges = finder.surface().edges();
  for (Index i = 0; i < std::ssize(edges); ++i)
    for (Index k = i + 1; k < std::ssize(edges); ++k) {
      const auto &a = edges[i], &b = edges[k];
      if (share_vertex(a, b)) continue;
      MovingPoints points{{t0[a[0]], t0[a[1]], t0[b[0]], t0[b[1]]}, {t1[a[0]], t1[a[1]], t1[b[0]], t1[b[1]]}};
      if (const auto time = edge_edge_impact(points)) all[{i, k}] = *time;
    }
  return all;
}

TEST_P(ContactFinderOf, SplitsPointsAndGivesEachItsContacts) {
  Random random(seed(5));
  const Solid solid = GetParam().make(random);
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions);
  Positions t0 = solid.positions;
  for (std::int64_t step = 0; step < scaled(3); ++step) {
    Positions t1 = t0;
    for (Vec3& x : t1) x += random.vector(0.1);
    const auto contacts = contacts_of_step(finder, t0, t1);
    const auto inside_t0 = BoundaryPathFinder<3>(mesh, t0).find_penetrating_vertices();
    std::vector<Index> inside;
    for (const auto& query : inside_t0)
      if (inside.empty() || inside.back() != query.source[0]) inside.push_back(query.source[0]);
    EXPECT_TRUE(std::ranges::equal(finder.penetrating_vertices(), inside));
    const auto is_inside = [&](Index v) { return std::binary_search(inside.begin(), inside.end(), v); };
    const auto edges_inside = finder.penetrating_edges();
    const auto is_edge_inside = [&](Index e) {
      return std::binary_search(edges_inside.begin(), edges_inside.end(), e);
    };

    auto first_times = first_times_of_vertices(finder, t0, t1);
    std::erase_if(first_times, [&](const auto& item) { return is_inside(item.first); });
    auto edge_times = times_of_edges(finder, t0, t1);
    std::erase_if(edge_times, [&](const auto& item) {
      return is_edge_inside(item.first.first) || is_edge_inside(item.first.second);
    });
    std::map<Index, double> first_of_edge;
    for (const auto& [pair, time] : edge_times)
      for (const Index e : {pair.first, pair.second}) keep_least(first_of_edge, e, time);

    std::size_t vertices = 0;
    std::map<Index, int> edges;
    for (const Contact& contact : contacts) {
      if (contact.kind == ContactKind::kVertexPath) {
        EXPECT_TRUE(is_inside(contact.point_feature));
      } else if (contact.kind == ContactKind::kEdgePath) {
        EXPECT_TRUE(is_edge_inside(contact.point_feature));
      } else if (contact.kind == ContactKind::kVertexFace) {
        ++vertices;
        ASSERT_TRUE(first_times.contains(contact.point_feature));
        EXPECT_EQ(contact.time, first_times[contact.point_feature]);
      } else {
        const auto found = edge_times.find({contact.point_feature, contact.surface_feature});
        ASSERT_NE(found, edge_times.end());
        EXPECT_EQ(contact.time, found->second);
        for (const Index e : {contact.point_feature, contact.surface_feature}) {
          auto [place, is_new] = edges.try_emplace(e, 0);
          place->second += contact.time == first_of_edge[e];
        }
      }
    }
    EXPECT_EQ(vertices, first_times.size());
    for (const auto& [edge, time] : first_of_edge) EXPECT_GE(edges[edge], 1) << "edge " << edge << " at " << time;
    t0 = t1;
  }
}

TEST_P(ContactFinderOf, SendsEachPenetratingPointWhereItsShortestPathLeads) {
  Random random(seed(6));
  const Solid solid = GetParam().make(random);
  const TetMesh mesh = solid.mesh();
  ContactFinder finder(mesh, {}, solid.positions, {}, in_mode(DetectionMode::kDcd));
  const auto contacts = contacts_of_step(finder, solid.positions, solid.positions);
  const BoundaryPathFinder<3> paths(mesh, solid.positions);
  const auto queries = paths.find_penetrating_vertices();
  const auto expected = paths.find_paths(queries);
  std::map<Index, std::vector<Vec3>> points;
  for (std::size_t i = 0; i < queries.size(); ++i)
    if (expected[i].status == PathStatus::kFound && expected[i].normal.norm() > 0)
      points[queries[i].source[0]].push_back(expected[i].point);
  std::map<Index, std::vector<Vec3>> found;
  for (const Contact& contact : contacts)
    if (contact.kind == ContactKind::kVertexPath) found[contact.point_feature].push_back(contact.point);
  ASSERT_EQ(found.size(), points.size());
  for (const auto& [vertex, places] : points)
    for (const Vec3& place : places)
      EXPECT_NE(std::find(found[vertex].begin(), found[vertex].end(), place), found[vertex].end());
}

INSTANTIATE_TEST_SUITE_P(Families, ContactFinderOf, testing::ValuesIn(solids::families()),
                         [](const auto& family) { return family.param.name; });

}  // namespace
}  // namespace selvage
