#include "bvh/traverse_pairs.h"
#include "self_collision/surface/neighbour_pairs.h"
#include "self_collision/surfaces.h"
#include "selvage/geometry/triangle_triangle.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace selvage {
namespace {

using surfaces::Random;
using surfaces::Surface;
using test::scaled;

Bvh hierarchy_over(const Surface& surface) {
  std::vector<Box> boxes;
  for (const auto& [a, b, c] : surface.triangles) {
    const std::array<Vec3, 3> corners{surface.positions[a], surface.positions[b], surface.positions[c]};
    boxes.push_back(bounding_box<3>(corners));
  }
  return Bvh(boxes);
}

bool share_vertex(const VertexTuple<3>& a, const VertexTuple<3>& b) {
  return std::any_of(a.begin(), a.end(), [&](Index v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

std::vector<IndexPair> sharing_triangles(const Surface& surface) {
  std::vector<IndexPair> pairs;
  for (Index i = 0; i < std::ssize(surface.triangles); ++i)
    for (Index j = i + 1; j < std::ssize(surface.triangles); ++j)
      if (share_vertex(surface.triangles[i], surface.triangles[j])) pairs.emplace_back(i, j);
  return pairs;
}

/// The triangles that a list says are neighbours, sorted.
std::vector<IndexPair> listed_triangles(const Bvh& bvh, std::span<const NeighbourPair> list) {
  std::vector<IndexPair> pairs;
  for (const NeighbourPair& listed : list) {
    const NodePair nodes = listed.pair;
    const std::uint64_t bits =
        listed.neighbours & traversal::primitive_pairs(bvh.nodes()[nodes.a], bvh.nodes()[nodes.b]);
    traversal::visit_each(bvh.nodes(), bvh.nodes(), {nodes.a, nodes.b, bits},
                          [&](Index i, Index j) { pairs.emplace_back(std::min(i, j), std::max(i, j)); });
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(Neighbours, AreAllTrianglesWithACommonVertexOnce) {
  Random random(1);
  for (const surfaces::Family& family : surfaces::families())
    for (std::int64_t n = 0; n < scaled(20); ++n) {
      const Surface surface = family.make(random);
      const Bvh bvh = hierarchy_over(surface);
      const auto list = list_neighbours(bvh, list_leaf_vertices(bvh, surface.triangles));
      ASSERT_EQ(listed_triangles(bvh, list), sharing_triangles(surface)) << family.name << n;
    }
}

TEST(Neighbours, StandBeforeThoseOfTheirChildren) {
  Random random(2);
  const Surface surface = surfaces::sheet(40, 40, random);
  const Bvh bvh = hierarchy_over(surface);
  const auto list = list_neighbours(bvh, list_leaf_vertices(bvh, surface.triangles));
  ASSERT_EQ(list.front().end, std::ssize(list));
  const auto parent_or_self = [&](Index child, Index node) {
    return child == node || bvh.nodes()[child].parent == node;
  };
  for (Index place = 0; place < std::ssize(list); ++place) {
    ASSERT_GT(list[place].end, place);
    for (Index below = place + 1; below < list[place].end; below = list[below].end) {
      ASSERT_LE(list[below].end, list[place].end);
      EXPECT_TRUE(parent_or_self(list[below].pair.a, list[place].pair.a));
      EXPECT_TRUE(parent_or_self(list[below].pair.b, list[place].pair.b));
    }
  }
}

/// Triangles around one vertex, all neighbours of all, and a sheet through them.
Surface pierced_fan(Index count, Random& random) {
  Surface fan;
  fan.positions.push_back(Vec3::Zero());
  for (Index i = 0; i <= count; ++i) {
    const double angle = 6 * i / static_cast<double>(count);
    fan.positions.emplace_back(std::cos(angle), std::sin(angle), random.within(-0.2, 0.2));
    if (i < count) fan.triangles.push_back({0, i + 1, i + 2});
  }
  Surface sheet = surfaces::sheet(12, 12, random);
  for (Vec3& x : sheet.positions) x = Vec3(x[0] / 6 - 1, 0.01 * x[0], x[1] / 6 - 1);
  return surfaces::together(fan, sheet);
}

TEST(Neighbours, OfAVertexOfVeryManyTrianglesAreNotAllListed) {
  Random random(3);
  const Surface surface = pierced_fan(1500, random);
  const Bvh bvh = hierarchy_over(surface);
  const auto list = list_neighbours(bvh, list_leaf_vertices(bvh, surface.triangles));
  EXPECT_LT(list.size(), 40 * bvh.nodes().size());
  EXPECT_TRUE(std::any_of(list.begin(), list.end(),
                          [](const NeighbourPair& listed) { return listed.neighbours == NeighbourPair::kUnlisted; }));

  // Searching a part needs no list.
  const TriangleMesh mesh = surface.mesh();
  std::vector<Index> all(surface.triangles.size());
  std::iota(all.begin(), all.end(), 0);
  for (const bool include_adjacent : {false, true}) {
    SelfCollisionOptions options;
    options.include_adjacent = include_adjacent;
    const SelfCollisionFinder finder(mesh, surface.positions, options);
    const auto pairs = finder.find_pairs();
    EXPECT_GT(pairs.size(), 100u);
    EXPECT_EQ(pairs, finder.find_pairs_of(all));
  }
}

Vec3 random_point(Random& random, double reach) {
  return {random.within(-reach, reach), random.within(-reach, reach), random.within(-reach, reach)};
}

Vec3 random_point_of(const std::array<Vec3, 3>& triangle, Random& random) {
  const double u = random.unit(), v = random.unit() * (1 - u);
  // Now and then on an edge or at a vertex, where it is decided whether triangles cross.
  const double weights[3] = {u, random.below(2) == 0 ? 0 : v, 0};
  const int first = random.below(3);
  const Vec3 &a = triangle[first], &b = triangle[(first + 1) % 3], &c = triangle[(first + 2) % 3];
  return random.below(4) == 0 ? a : a + weights[0] * (b - a) + weights[1] * (c - a);
}

// Each pair of triangles meets, or does not, by 2^-4 to 2^-44 of its size: single precision must know what it does not
// know.
TEST(Neighbours, PairsThatMeetOrPartByAHairAreDecidedExactly) {
  Random random(4);
  for (std::int64_t n = 0; n < scaled(200); ++n) {
    Surface surface;
    std::vector<TrianglePair> expected;
    const Vec3 origin = random_point(random, n % 2 == 0 ? 1 : 1000);
    for (Index pair = 0; pair < 64; ++pair) {
      std::array<Vec3, 3> a, b;
      for (Vec3& x : a) x = origin + Vec3(3 * (pair % 8), 3 * (pair / 8), 0) + random_point(random, 1);
      for (Vec3& x : b) x = random_point(random, 1);
      const double hair = std::ldexp(1.0, -4 - random.below(41));
      const Vec3 shift = random_point_of(a, random) - random_point_of(b, random) + random_point(random, hair);
      for (Vec3& x : b) x += shift;
      if (const TriangleContact contact = classify_contact(a, b); contact != TriangleContact::kDisjoint)
        expected.push_back({2 * pair, 2 * pair + 1, contact});
      for (const auto& corners : {a, b}) {
        const auto first = static_cast<Index>(surface.positions.size());
        surface.triangles.push_back({first, first + 1, first + 2});
        surface.positions.insert(surface.positions.end(), corners.begin(), corners.end());
      }
    }
    const TriangleMesh mesh = surface.mesh();
    auto found = SelfCollisionFinder(mesh, surface.positions).find_pairs();
    std::erase_if(found, [](const TrianglePair& pair) { return pair.first / 2 != pair.second / 2; });
    ASSERT_EQ(found.size(), expected.size()) << n;
    for (std::size_t i = 0; i < found.size(); ++i) ASSERT_TRUE(found[i] == expected[i]) << n << " " << i;
  }
}

}  // namespace
}  // namespace selvage
