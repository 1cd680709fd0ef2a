// Other ends of some vertices, against a finder that is made for them.
#include "self_collision/surfaces.h"
#include "selvage/self_collision/continuous_collision.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace selvage {
namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using test::seed;
using Positions = std::vector<Vec3>;

bool has_any(std::span<const Index> vertices, std::span<const Index> of) {
  return std::find_first_of(vertices.begin(), vertices.end(), of.begin(), of.end()) != vertices.end();
}

ContinuousPairs with_any(const TriangleMesh& mesh, ContinuousPairs pairs, std::span<const Index> vertices) {
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
    return !has_any(vertices, {&p.vertex, 1}) && !has_any(vertices, mesh.triangles()[p.face]);
  });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return !has_any(vertices, mesh.edges()[p.first]) && !has_any(vertices, mesh.edges()[p.second]);
  });
  return pairs;
}

/// Steps, in each of which some ends are moved several times.
struct MovedEnds {
  std::vector<ContinuousPairs> found;
  std::size_t met = 0;

  bool operator==(const MovedEnds& other) const { return found == other.found; }
};

MovedEnds move_over_steps(const Surface& surface, const SelfCollisionOptions& options, Random random, bool compares) {
  const TriangleMesh mesh = surface.mesh();
  const auto count = static_cast<std::uint64_t>(surface.positions.size());
  Positions start = surface.positions, end = start;
  ContinuousCollisionFinder finder(mesh, start, end, options);
  MovedEnds moved;
  for (int step = 0; step < 5; ++step) {
    for (Vec3& x : end) x += random.vector(random.below(2) == 0 ? 0.01 : 0.2);
    finder.update(start, end);
    for (int round = 0; round < 3; ++round) {
      std::vector<Index> vertices;
      for (std::uint64_t n = random.below(1 + count / 8); n > 0; --n)
        vertices.push_back(static_cast<Index>(random.below(count)));
      // The largest leave the range that boxes are made for.
      const double way = random.below(8) == 0 ? 1000 : random.below(2) == 0 ? 0.3 : 1e-3;
      for (const Index v : vertices) end[v] = start[v] + random.vector(way);
      moved.found.push_back(finder.move_ends(vertices, end));
      moved.met += moved.found.back().vertex_face.size() + moved.found.back().edge_edge.size();
      if (!compares) continue;
      const ContinuousPairs all = ContinuousCollisionFinder(mesh, start, end, options).find_pairs();
      EXPECT_EQ(moved.found.back(), with_any(mesh, all, vertices)) << "step " << step << ", round " << round;
      if (round == 1) {
        EXPECT_EQ(finder.find_pairs(), all);
      }
    }
    start = end;
  }
  return moved;
}

Surface near_sheets(Random& random) {
  Surface lower = surfaces::sheet(8, 8, random), upper = surfaces::sheet(8, 8, random);
  for (Vec3& x : upper.positions) x[2] += 0.02;
  return surfaces::together(lower, upper);
}

class MoveEndsOf : public testing::TestWithParam<surfaces::Family> {};

TEST_P(MoveEndsOf, FindsThePairsOfTheseVertices) {
  Random random(seed(90));
  for (std::int64_t n = 0; n < scaled(4); ++n)
    move_over_steps(GetParam().make(random), {}, Random(random.bits()), true);
}

INSTANTIATE_TEST_SUITE_P(All, MoveEndsOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST(MoveEnds, FindsThemWithEveryOption) {
  Random random(seed(91));
  std::size_t met = 0;
  for (std::int64_t n = 0; n < scaled(4); ++n) {
    const Surface surface = near_sheets(random);
    for (const CullingMethod method : {CullingMethod::kBvh, CullingMethod::kEnhancedDualCone, CullingMethod::kAuto}) {
      SelfCollisionOptions options;
      options.method = method;
      met += move_over_steps(surface, options, Random(random.bits()), true).met;
      options.asked_once = true;
      move_over_steps(surface, options, Random(random.bits()), true);
    }
    SelfCollisionOptions options;
    options.thickness.assign(surface.positions.size(), 0.01);
    options.filters.neighbour_rings = 1;
    move_over_steps(surface, options, Random(random.bits()), true);
  }
  EXPECT_GT(met, static_cast<std::size_t>(scaled(400)));
}

TEST(MoveEnds, FindsTheSameForAnyNumberOfThreads) {
  Random random(seed(92));
  const Surface surface = near_sheets(random);
  const std::uint64_t bits = random.bits();
  test::same_for_any_threads([&] { return move_over_steps(surface, {}, Random(bits), false); });
}

TEST(MoveEnds, ComparesOnlyWhatIsNear) {
  Random random(seed(93));
  const Surface surface = surfaces::sheet(60, 60, random);
  const TriangleMesh mesh = surface.mesh();
  SelfCollisionOptions options;
  options.method = CullingMethod::kBvh;
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions, options);
  ContinuousCounters all, near;
  finder.find_pairs(&all);
  const Index vertex = 1234;
  finder.move_ends({&vertex, 1}, surface.positions, &near);
  EXPECT_LT(50 * near.box_pairs, all.box_pairs);
}

TEST(MoveEnds, RefuseWhatAFinderRefuses) {
  Random random(seed(94));
  const Surface surface = near_sheets(random);
  const TriangleMesh mesh = surface.mesh();
  ContinuousCollisionFinder finder(mesh, surface.positions, surface.positions);
  const ContinuousPairs before = finder.find_pairs();
  Positions broken = surface.positions;
  broken[5][1] = std::numeric_limits<double>::quiet_NaN();
  const Index vertices[] = {5, -1, mesh.vertex_count()};
  for (const Index& v : vertices) EXPECT_ANY_THROW(finder.move_ends({&v, 1}, v == 5 ? broken : surface.positions));
  broken.pop_back();
  EXPECT_ANY_THROW(finder.move_ends({vertices, 1}, broken));
  EXPECT_EQ(finder.find_pairs(), before);
}

}  // namespace
}  // namespace selvage
