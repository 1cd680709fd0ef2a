#include "selvage/self_collision/continuous_collision.h"

#include "self_collision/surfaces.h"
#include "selvage/core/error.h"
#include "selvage/geometry/continuous.h"
#include "selvage/geometry/moving_distance.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace selvage {

void PrintTo(const VertexFacePair& pair, std::ostream* out) {
  *out << "vertex " << pair.vertex << " face " << pair.face;
}
void PrintTo(const EdgeEdgePair& pair, std::ostream* out) {
  *out << "edges " << pair.first << " " << pair.second;
}

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

MovingPoints moving(const Positions& t0, const Positions& t1, const std::array<Index, 4>& v) {
  return {{t0[v[0]], t0[v[1]], t0[v[2]], t0[v[3]]}, {t1[v[0]], t1[v[1]], t1[v[2]], t1[v[3]]}};
}

/// Every vertex with every face, every edge with every edge.
ContinuousPairs all_pairs(const TriangleMesh& mesh, const Positions& t0, const Positions& t1,
                          const std::vector<double>& thickness = {}) {
  ContinuousPairs pairs;
  surfaces::visit_vertex_faces(mesh, [&](Index v, Index f) {
    const auto& [a, b, c] = mesh.triangles()[f];
    const MovingPoints points = moving(t0, t1, {v, a, b, c});
    const double near =
        surfaces::thickest(thickness, std::span(&v, 1)) + surfaces::thickest(thickness, mesh.triangles()[f]);
    if (vertex_meets_face(points) || vertex_comes_near_face(points, near)) pairs.vertex_face.push_back({v, f});
  });
  surfaces::visit_edge_pairs(mesh, [&](Index e, Index f) {
    const auto &a = mesh.edges()[e], &b = mesh.edges()[f];
    const MovingPoints points = moving(t0, t1, {a[0], a[1], b[0], b[1]});
    const double near = surfaces::thickest(thickness, a) + surfaces::thickest(thickness, b);
    if (edge_meets_edge(points) || edge_comes_near_edge(points, near)) pairs.edge_edge.push_back({e, f});
  });
  return pairs;
}

class Continuous : public testing::TestWithParam<surfaces::Family> {
 protected:
  /// The end of a step: no motion, little, much; everything the same way, or each vertex by itself; on a grid or not.
  Positions step_from(const Surface& surface, std::int64_t kind, Random& random) const {
    constexpr double kAmounts[] = {0, 0.05, 0.5, 3};
    Surface end = surfaces::jittered(surface, kAmounts[kind % 4], random);
    if (kind % 3 == 0)
      for (std::size_t v = 0; v < end.positions.size() / 2; ++v) end.positions[v] += Vec3(1, -1, 0.5);
    return kind % 5 == 4 ? end.positions : surfaces::snapped(end, kind % 2 == 0 ? 1 : 7).positions;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Continuous, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(Continuous, PairsAreThoseOfAllPairs) {
  Random random(1);
  for (std::int64_t n = 0; n < scaled(12); ++n) {
    const Surface surface = n % 4 == 3 ? GetParam().make(random) : surfaces::snapped(GetParam().make(random), 5);
    const TriangleMesh mesh = surface.mesh();
    const Positions end = step_from(surface, n, random);
    const ContinuousPairs expected = all_pairs(mesh, surface.positions, end);
    for (const bool asked_once : {false, true}) {
      SelfCollisionOptions options;
      options.asked_once = asked_once;
      const ContinuousCollisionFinder finder(mesh, surface.positions, end, options);
      const ContinuousPairs found = finder.find_pairs();
      ASSERT_EQ(found.vertex_face, expected.vertex_face) << n;
      ASSERT_EQ(found.edge_edge, expected.edge_edge) << n;
      ASSERT_EQ(finder.has_pairs(), !expected.empty()) << n;
    }
  }
}

TEST_P(Continuous, PairsAreTheSameAfterARefitAndAfterARebuild) {
  Random random(2);
  for (std::int64_t n = 0; n < scaled(5); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    const TriangleMesh mesh = surface.mesh();
    ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
    for (int step = 0; step < 4; ++step) {
      const Positions start = step_from(surface, step, random), end = step_from(surface, step + 1, random);
      const ContinuousPairs expected = ContinuousCollisionFinder(mesh, start, end).find_pairs();
      finder.update(start, end);
      ASSERT_EQ(finder.find_pairs(), expected) << n;
      finder.rebuild(start, end);
      ASSERT_EQ(finder.find_pairs(), expected) << n;
    }
  }
}

TEST_P(Continuous, ImpactTimesAndTheFreeStepAreThoseOfThePairs) {
  Random random(3);
  for (std::int64_t n = 0; n < scaled(4); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 5);
    const TriangleMesh mesh = surface.mesh();
    const Positions end = step_from(surface, 4 * n + 1, random);
    const ContinuousCollisionFinder finder(mesh, surface.positions, end);
    const ContinuousPairs pairs = finder.find_pairs();
    double earliest = 1;
    for (const double t : finder.find_impact_times(pairs.vertex_face)) earliest = std::min(earliest, t);
    for (const double t : finder.find_impact_times(pairs.edge_edge)) earliest = std::min(earliest, t);
    EXPECT_GE(earliest, 0);
    ASSERT_EQ(finder.find_free_step(), earliest);
    if (earliest == 0) continue;
    // A step cut off before the earliest impact is free, up to the rounding of where it is cut off.
    Positions cut = surface.positions;
    for (std::size_t v = 0; v < cut.size(); ++v) cut[v] += (end[v] - cut[v]) * (earliest - 1e-6);
    if (earliest > 1e-5) {
      EXPECT_FALSE(ContinuousCollisionFinder(mesh, surface.positions, cut).has_pairs()) << n;
    }
  }
}

TEST_P(Continuous, FiltersKeepWhatTheirTrianglesKeep) {
  Random random(4);
  for (std::int64_t n = 0; n < scaled(3); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 5);
    const TriangleMesh mesh = surface.mesh();
    const Positions end = step_from(surface, n + 1, random);
    SelfCollisionOptions options;
    for (Index t = 0; t < mesh.triangle_count(); ++t) options.filters.groups.push_back(random.below(3) - 1);
    const auto keeps = [&](std::span<const Index> a, std::span<const Index> b) {
      for (const Index i : a)
        for (const Index j : b) {
          const Index group = options.filters.groups[i];
          if (i != j && (group == kNone || group != options.filters.groups[j])) return true;
        }
      return false;
    };
    ContinuousPairs expected = all_pairs(mesh, surface.positions, end);
    std::erase_if(expected.vertex_face, [&](const VertexFacePair& p) {
      return !keeps(mesh.vertex_triangles(p.vertex), std::span(&p.face, 1));
    });
    std::erase_if(expected.edge_edge, [&](const EdgeEdgePair& p) {
      return !keeps(mesh.edge_triangles(p.first), mesh.edge_triangles(p.second));
    });
    ASSERT_EQ(ContinuousCollisionFinder(mesh, surface.positions, end, options).find_pairs(), expected) << n;
    // Neighbours and distances at rest, of vertices, faces and edges themselves.
    options.filters = {};
    options.filters.neighbour_rings = 1;
    expected = all_pairs(mesh, surface.positions, end);
    const auto joined = [&](std::span<const Index> a, std::span<const Index> b) {
      return std::any_of(mesh.edges().begin(), mesh.edges().end(), [&](const auto& e) {
        return (surfaces::has_vertex(a, e[0]) && surfaces::has_vertex(b, e[1])) ||
               (surfaces::has_vertex(a, e[1]) && surfaces::has_vertex(b, e[0]));
      });
    };
    std::erase_if(expected.vertex_face,
                  [&](const VertexFacePair& p) { return joined(std::span(&p.vertex, 1), mesh.triangles()[p.face]); });
    std::erase_if(expected.edge_edge,
                  [&](const EdgeEdgePair& p) { return joined(mesh.edges()[p.first], mesh.edges()[p.second]); });
    ASSERT_EQ(ContinuousCollisionFinder(mesh, surface.positions, end, options).find_pairs(), expected) << n;
  }
}

TEST_P(Continuous, ThicknessBringsWhatComesNear) {
  Random random(8);
  std::size_t met = 0, near = 0;
  for (std::int64_t n = 0; n < scaled(6); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    const Positions end = step_from(surface, 5 * n + 4, random);
    SelfCollisionOptions options;
    for (Index v = 0; v < mesh.vertex_count(); ++v)
      options.thickness.push_back(random.below(3) == 0 ? 0 : random.within(0, 0.2));
    const ContinuousPairs expected = all_pairs(mesh, surface.positions, end, options.thickness);
    const ContinuousCollisionFinder finder(mesh, surface.positions, end, options);
    ASSERT_EQ(finder.find_pairs(), expected) << n;
    ASSERT_EQ(finder.has_pairs(), !expected.empty()) << n;
    near += expected.vertex_face.size() + expected.edge_edge.size();
    options.thickness.assign(mesh.vertex_count(), 0);
    const ContinuousPairs thin = ContinuousCollisionFinder(mesh, surface.positions, end, options).find_pairs();
    ASSERT_EQ(thin, all_pairs(mesh, surface.positions, end)) << n;
    met += thin.vertex_face.size() + thin.edge_edge.size();
    ASSERT_EQ(finder.find_free_step(), ContinuousCollisionFinder(mesh, surface.positions, end).find_free_step());
  }
  EXPECT_GE(near, met);
}

/// A triangle in the plane z = 0 and another that falls on it, from 1 above at the start to `depth` below at the end.
struct Fall {
  Surface start;
  Positions end;

  explicit Fall(double depth, const Vec3& aside = Vec3::Zero()) {
    start.positions = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 1}, {1, 1, 2}, {2, 1, 2}};
    start.triangles = {{0, 1, 2}, {3, 4, 5}};
    end = start.positions;
    for (int v = 3; v < 6; ++v) end[v] += aside - Vec3(0, 0, 1 + depth);
  }
};

TEST(ContinuousByHand, VertexThatFallsOnAFace) {
  const Fall through(0.5), touching(0), above(-0x1p-50), aside(1, Vec3(-3, -3, 0));
  const TriangleMesh mesh = through.start.mesh();
  const auto find = [&](const Fall& fall) { return ContinuousCollisionFinder(mesh, fall.start.positions, fall.end); };
  const auto expected = std::vector<VertexFacePair>{{3, 0}};
  EXPECT_EQ(find(through).find_pairs().vertex_face, expected);
  EXPECT_NEAR(find(through).find_free_step(), 2.0 / 3, 1e-6);
  EXPECT_LE(find(through).find_free_step(), 2.0 / 3);
  EXPECT_EQ(find(touching).find_pairs().vertex_face, expected);
  EXPECT_NEAR(find(touching).find_free_step(), 1, 1e-6);
  EXPECT_TRUE(find(above).find_pairs().empty());
  EXPECT_EQ(find(above).find_free_step(), 1);
  EXPECT_TRUE(find(aside).find_pairs().vertex_face.empty());
  EXPECT_TRUE(std::isnan(find(above).find_impact_times(expected)[0]));
}

TEST(ContinuousByHand, VertexThatComesNearAFace) {
  const Fall above(-0.25);
  const TriangleMesh mesh = above.start.mesh();
  SelfCollisionOptions options;
  options.thickness = {0, 0, 0.1, 0.2, 0, 0};  // the face has the largest of its vertices
  const auto find = [&] { return ContinuousCollisionFinder(mesh, above.start.positions, above.end, options); };
  EXPECT_EQ(find().find_pairs().vertex_face, (std::vector<VertexFacePair>{{3, 0}}));
  EXPECT_EQ(find().find_free_step(), 1);
  options.thickness[2] = 0.04;
  EXPECT_TRUE(find().find_pairs().vertex_face.empty());
}

TEST(ContinuousByHand, SheetThroughASheetAndBack) {
  Random random(5);
  const Surface pair = surfaces::together(surfaces::sheet(6, 6, random), surfaces::sheet(6, 6, random));
  const TriangleMesh mesh = pair.mesh();
  Positions start = pair.positions, end = pair.positions;
  for (std::size_t v = start.size() / 2; v < start.size(); ++v) {
    start[v] += Vec3(0.3, 0.2, 1);
    end[v] += Vec3(0.3, 0.2, -1);
  }
  const ContinuousCollisionFinder forth(mesh, start, end), back(mesh, end, start), stay(mesh, start, start);
  const ContinuousPairs pairs = forth.find_pairs();
  EXPECT_GT(pairs.vertex_face.size(), 60u);
  EXPECT_EQ(pairs, back.find_pairs());
  EXPECT_EQ(pairs, all_pairs(mesh, start, end));
  EXPECT_NEAR(forth.find_free_step(), 0.5, 1e-6);
  EXPECT_FALSE(stay.has_pairs());
}

TEST(ContinuousOf, LargeClothIsTheSameForAnyNumberOfThreads) {
  IndexedMesh cloth = make_cloth(4, 4, 0.05);
  Random random(6);
  Positions end = cloth.positions;
  for (std::size_t v = 0; v < end.size(); ++v) {
    cloth.positions[v][2] = 0.2 * std::sin(4 * end[v][0]);
    end[v] += Vec3(random.within(-0.1, 0.1), 0.3 * std::sin(3 * end[v][0]), random.within(-0.1, 0.1));
  }
  const TriangleMesh mesh(static_cast<Index>(end.size()), cloth.triangles);
  ContinuousCounters counters;
  const auto [pairs, exact_tests] = test::same_for_any_threads([&] {
    counters = {};
    const ContinuousPairs found = ContinuousCollisionFinder(mesh, cloth.positions, end).find_pairs(&counters);
    return std::pair(found, counters.exact_tests);
  });
  EXPECT_GT(pairs.edge_edge.size(), 100u);
  EXPECT_TRUE(std::is_sorted(pairs.vertex_face.begin(), pairs.vertex_face.end()));
  EXPECT_TRUE(std::is_sorted(pairs.edge_edge.begin(), pairs.edge_edge.end()));
  EXPECT_LT(exact_tests, counters.vertex_face_boxes + counters.edge_edge_boxes);
}

TEST(ContinuousOf, BadInputIsRefused) {
  Random random(7);
  const Surface surface = surfaces::sheet(2, 2, random);
  const TriangleMesh mesh = surface.mesh();
  const Positions& x = surface.positions;
  Positions broken = x;
  broken[2][2] = HUGE_VAL;
  EXPECT_THROW(ContinuousCollisionFinder(mesh, x, broken), Error);
  EXPECT_THROW(ContinuousCollisionFinder(mesh, broken, x), Error);
  EXPECT_THROW(ContinuousCollisionFinder(mesh, x, std::span(x).first(8)), Error);
  SelfCollisionOptions thick;
  thick.thickness.assign(8, 0.1);
  EXPECT_THROW(ContinuousCollisionFinder(mesh, x, x, thick), Error);
  thick.thickness.assign(9, -0.1);
  EXPECT_THROW(ContinuousCollisionFinder(mesh, x, x, thick), Error);
  const ContinuousCollisionFinder finder(mesh, x, x);
  EXPECT_THROW(finder.find_impact_times(std::vector<VertexFacePair>{{9, 0}}), Error);
  EXPECT_THROW(finder.find_impact_times(std::vector<VertexFacePair>{{0, 8}}), Error);
  EXPECT_THROW(finder.find_impact_times(std::vector<EdgeEdgePair>{{0, 16}}), Error);
}

}  // namespace
}  // namespace selvage
