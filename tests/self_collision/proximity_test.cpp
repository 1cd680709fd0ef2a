#include "selvage/self_collision/proximity.h"

#include "self_collision/surfaces.h"
#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/distance.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

static_assert(!std::is_constructible_v<ProximityFinder, TriangleMesh, std::span<const Vec3>, double>);
static_assert(std::is_constructible_v<ProximityFinder, const TriangleMesh&, std::span<const Vec3>, double>);

/// The square root, but 0 only where sets meet.
double distance_of(double squared, bool meet) {
  return meet ? 0 : std::max(std::sqrt(squared), std::numeric_limits<double>::denorm_min());
}

/// Every vertex with every face, every edge with every edge: (numbers, distance), 0 where they meet.
using Measured = std::vector<std::pair<IndexPair, double>>;

Measured all_vertex_faces(const TriangleMesh& mesh, const Positions& x, double distance) {
  Measured pairs;
  surfaces::visit_vertex_faces(mesh, [&](Index v, Index f) {
    const auto& [a, b, c] = mesh.triangles()[f];
    const std::array<Vec3, 4> points{x[v], x[a], x[b], x[c]};
    const double apart = distance_of(closest_point_on_triangle(x[v], x[a], x[b], x[c]).squared_distance,
                                     vertex_meets_face({points, points}));
    if (apart < distance) pairs.push_back({{v, f}, apart});
  });
  return pairs;
}

Measured all_edges(const TriangleMesh& mesh, const Positions& x, double distance) {
  Measured pairs;
  surfaces::visit_edge_pairs(mesh, [&](Index e, Index f) {
    const auto &a = mesh.edges()[e], &b = mesh.edges()[f];
    const std::array<Vec3, 4> points{x[a[0]], x[a[1]], x[b[0]], x[b[1]]};
    const double squared = squared_distance(std::array{points[0], points[1]}, std::array{points[2], points[3]});
    const double apart = distance_of(squared, edge_meets_edge({points, points}));
    if (apart < distance) pairs.push_back({{e, f}, apart});
  });
  return pairs;
}

Measured numbers_of(const std::vector<NearVertexFace>& pairs) {
  Measured result;
  for (const NearVertexFace& pair : pairs) result.push_back({{pair.vertex, pair.face}, pair.distance});
  return result;
}

Measured numbers_of(const std::vector<NearEdges>& pairs) {
  Measured result;
  for (const NearEdges& pair : pairs) result.push_back({{pair.first, pair.second}, pair.distance});
  return result;
}

/// Nearest points lie where they are said to, and as far apart as they are said to.
void expect_consistent(const NearPairs& pairs, const TriangleMesh& mesh, const Positions& x) {
  for (const NearVertexFace& pair : pairs.vertex_face) {
    const auto& t = mesh.triangles()[pair.face];
    const Vec3 point = pair.barycentric[0] * x[t[0]] + pair.barycentric[1] * x[t[1]] + pair.barycentric[2] * x[t[2]];
    ASSERT_LT((point - pair.nearest[1]).norm(), 1e-12);
    ASSERT_EQ(pair.nearest[0], x[pair.vertex]);
    ASSERT_NEAR((pair.nearest[0] - pair.nearest[1]).norm(), pair.distance, 1e-12);
  }
  for (const NearEdges& pair : pairs.edge_edge) {
    for (int i = 0; i < 2; ++i) {
      const auto& e = mesh.edges()[i == 0 ? pair.first : pair.second];
      ASSERT_LT(((1 - pair.place[i]) * x[e[0]] + pair.place[i] * x[e[1]] - pair.nearest[i]).norm(), 1e-12);
      ASSERT_GE(pair.place[i], 0);
      ASSERT_LE(pair.place[i], 1);
    }
    // Of nearly parallel edges the places are known less well than the distance.
    ASSERT_NEAR((pair.nearest[0] - pair.nearest[1]).norm(), pair.distance, 1e-6);
  }
}

class Proximity : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, Proximity, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(Proximity, FindsWhatAllPairsOneByOneGive) {
  Random random(31);
  for (std::int64_t n = 0; n < scaled(12); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    // Distances that lattices have exactly, too: these pairs are no nearer than that.
    const double distance = n % 3 == 0 ? 1 : random.within(0.01, 1.5);
    const NearPairs pairs = ProximityFinder(mesh, surface.positions, distance).find_pairs();
    ASSERT_EQ(numbers_of(pairs.vertex_face), all_vertex_faces(mesh, surface.positions, distance)) << n;
    ASSERT_EQ(numbers_of(pairs.edge_edge), all_edges(mesh, surface.positions, distance)) << n;
    ASSERT_NO_FATAL_FAILURE(expect_consistent(pairs, mesh, surface.positions)) << n;
  }
}

TEST_P(Proximity, UpdateGivesWhatANewFinderGives) {
  Random random(32);
  for (std::int64_t n = 0; n < scaled(4); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    ProximityFinder finder(mesh, surface.positions, 0.3);
    for (const double amount : {0.1, 1.0, 1e6}) {
      const Surface moved = surfaces::jittered(surface, amount, random);
      finder.update(moved.positions);
      const NearPairs pairs = finder.find_pairs(), expected = ProximityFinder(mesh, moved.positions, 0.3).find_pairs();
      ASSERT_EQ(numbers_of(pairs.vertex_face), numbers_of(expected.vertex_face));
      ASSERT_EQ(numbers_of(pairs.edge_edge), numbers_of(expected.edge_edge));
    }
  }
}

/// All that a search finds, for comparison bit by bit.
using Found = std::vector<std::tuple<IndexPair, double, std::vector<double>>>;

Found all_of(const NearPairs& pairs) {
  Found found;
  const auto add = [&](IndexPair numbers, double distance, std::span<const double> places,
                       const std::array<Vec3, 2>& nearest) {
    std::vector<double> rest(places.begin(), places.end());
    for (const Vec3& point : nearest) rest.insert(rest.end(), {point[0], point[1], point[2]});
    found.emplace_back(numbers, distance, rest);
  };
  for (const NearVertexFace& pair : pairs.vertex_face)
    add({pair.vertex, pair.face}, pair.distance, pair.barycentric, pair.nearest);
  for (const NearEdges& pair : pairs.edge_edge) add({pair.first, pair.second}, pair.distance, pair.place, pair.nearest);
  return found;
}

/// Two sheets that turn, and of which one now and then comes nearer; some vertices tremble, and some jump.
class TurningSheets {
 public:
  explicit TurningSheets(Random& random) : random_(random), sheet_(surfaces::sheet(24, 24, random)) {
    const Index count = std::ssize(sheet_.positions);
    std::vector<TriangleMesh::Triangle> triangles = sheet_.triangles;
    for (auto [a, b, c] : sheet_.triangles) triangles.push_back({a + count, b + count, c + count});
    mesh_ = TriangleMesh(2 * count, triangles);
  }
  const TriangleMesh& mesh() const { return mesh_; }

  Positions at(int step) {
    const double angle = 0.002 * step;
    Positions all;
    for (const double height : {0.0, 0.45 - 0.03 * std::max(0, step % 16 - 11)})
      for (const Vec3& p : sheet_.positions)
        all.emplace_back(std::cos(angle) * p[0] - std::sin(angle) * p[1] + 0.01 * step,
                         std::sin(angle) * p[0] + std::cos(angle) * p[1], p[2] + height);
    for (Index v = 0; v < std::ssize(all); v += 97) all[v][2] += random_.within(-0.05, 0.05);
    if (step % 17 == 16) all[random_.below(std::ssize(all))] += Vec3(0.5, 0.2, 0.1);
    return all;
  }

 private:
  Random& random_;
  Surface sheet_;
  TriangleMesh mesh_;
};

TEST(ProximityLists, GiveWhatANewFinderGives) {
  Random random(34);
  TurningSheets sheets(random);
  PairFilters filters;
  filters.rest_positions = sheets.at(0);
  for (std::size_t v = filters.rest_positions.size() / 2; v < filters.rest_positions.size(); ++v)
    filters.rest_positions[v][2] += 100;
  filters.rest_distance = 0.4;
  ProximityFinder finder(sheets.mesh(), sheets.at(0), 0.4, filters);
  const std::int64_t steps = scaled(90);
  std::int64_t by_list = 0;
  bool found_any = false, found_none = false;
  for (int step = 1; step <= steps; ++step) {
    const Positions x = sheets.at(step);
    finder.update(x);
    ContinuousCounters counters;
    const Found found = all_of(finder.find_pairs(&counters));
    by_list += counters.node_pairs == 0;
    found_any |= found.size() > 1000;
    found_none |= found.empty();
    ASSERT_EQ(found, all_of(ProximityFinder(sheets.mesh(), x, 0.4, filters).find_pairs())) << step;
  }
  if (steps >= 20) {
    EXPECT_GT(2 * by_list, steps) << "most are by a list";
    EXPECT_TRUE(found_any && found_none);
  }
}

TEST(ProximityLists, EndWhereAllJumps) {
  Random random(35);
  const Surface sheet = surfaces::jittered(surfaces::sheet(12, 12, random), 0.6, random);
  const TriangleMesh mesh = sheet.mesh();
  ProximityFinder finder(mesh, sheet.positions, 0.3);
  for (std::int64_t n = 0; n < scaled(40); ++n) {
    const double amount = n % 5 == 0 ? 1e6 : n % 3 == 0 ? 0.5 : 1e-3;
    const Positions x = surfaces::jittered(sheet, amount, random).positions;
    finder.update(x);
    ASSERT_EQ(all_of(finder.find_pairs()), all_of(ProximityFinder(mesh, x, 0.3).find_pairs())) << n;
  }
}

TEST(ProximityByHand, EdgesAreMeasuredAsOneByOne) {
  Random random(36);
  for (std::int64_t n = 0; n < scaled(300); ++n) {
    // Of thin triangles, whose edges take all directions, are parallel, or points; also where squares vanish.
    const double scale = n % 4 == 3 ? std::ldexp(1.0, n % 8 == 3 ? -400 : 300) : 1;
    Positions x;
    std::vector<TriangleMesh::Triangle> triangles;
    for (Index t = 0; t < 6; ++t) {
      for (int k = 0; k < 3; ++k) {
        Vec3 p(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
        if (n % 3 == 0) p = p.array().round();
        x.emplace_back(scale * p);
      }
      triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const TriangleMesh mesh(18, triangles);
    for (const NearEdges& pair : ProximityFinder(mesh, x, 10 * scale).find_pairs().edge_edge) {
      const auto &a = mesh.edges()[pair.first], &b = mesh.edges()[pair.second];
      const ClosestSegmentPoints closest = closest_points({x[a[0]], x[a[1]]}, {x[b[0]], x[b[1]]});
      ASSERT_EQ(pair.place, closest.place) << n;
      const double measured = distance_of(closest.difference.squaredNorm(), false);
      ASSERT_EQ(pair.distance, pair.distance > 0 ? measured : 0) << n;
    }
  }
}

TEST(ProximityByHand, TwoTrianglesAboveEachOther) {
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const Positions x{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0.25}, {1, 1, 2}, {2, 1, 2}};
  const NearPairs pairs = ProximityFinder(mesh, x, 0.5).find_pairs();
  ASSERT_EQ(pairs.vertex_face.size(), 1u);
  EXPECT_EQ(pairs.vertex_face[0].vertex, 3);
  EXPECT_EQ(pairs.vertex_face[0].face, 0);
  EXPECT_EQ(pairs.vertex_face[0].distance, 0.25);
  EXPECT_EQ(pairs.vertex_face[0].nearest[1], Vec3(1, 1, 0));
  EXPECT_EQ(pairs.vertex_face[0].barycentric, (std::array{0.5, 0.25, 0.25}));
  EXPECT_TRUE(pairs.edge_edge.empty());
  EXPECT_TRUE(ProximityFinder(mesh, x, 0.25).find_pairs().empty());
  EXPECT_FALSE(ProximityFinder(mesh, x, 0.25 * (1 + 0x1p-52)).find_pairs().empty());
}

TEST(ProximityByHand, WhatMeetsIsAtDistanceZero) {
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const Positions x{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}, {1, 1, 2}, {2, 1, 2}};
  const NearPairs pairs = ProximityFinder(mesh, x, 1e-9).find_pairs();
  ASSERT_EQ(pairs.vertex_face.size(), 1u);
  EXPECT_EQ(pairs.vertex_face[0].distance, 0);
}

TEST(ProximityByHand, FiltersApply) {
  const TriangleMesh mesh(6, {{0, 1, 2}, {3, 4, 5}});
  const Positions x{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0.25}, {1, 1, 2}, {2, 1, 2}};
  PairFilters filters;
  filters.forbidden_pairs = {{0, 1}};
  EXPECT_TRUE(ProximityFinder(mesh, x, 0.5, filters).find_pairs().empty());
}

TEST(ProximityByHand, SameBitsForAnyNumberOfThreads) {
  Random random(33);
  const Surface sheet = surfaces::jittered(surfaces::sheet(40, 40, random), 0.6, random);
  const TriangleMesh mesh = sheet.mesh();
  const ProximityFinder finder(mesh, sheet.positions, 0.2);
  const auto [vertex_face, edge_edge] = test::same_for_any_threads([&] {
    const NearPairs pairs = finder.find_pairs();
    return std::pair(numbers_of(pairs.vertex_face), numbers_of(pairs.edge_edge));
  });
  EXPECT_GT(vertex_face.size() + edge_edge.size(), 100u);
}

TEST(ProximityByHand, RefusesBadInput) {
  const TriangleMesh mesh(3, {{0, 1, 2}});
  const Positions x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(ProximityFinder(mesh, x, 0), Error);
  EXPECT_THROW(ProximityFinder(mesh, x, std::numeric_limits<double>::infinity()), Error);
  EXPECT_THROW(ProximityFinder(mesh, std::span(x).first(2), 1), Error);
  ProximityFinder finder(mesh, x, 1);
  Positions broken = x;
  broken[1][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(finder.update(broken), Error);
  EXPECT_TRUE(finder.find_pairs().empty());
}

}  // namespace
}  // namespace selvage
