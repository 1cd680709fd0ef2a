#include "self_collision/oracle.h"
#include "selvage/core/error.h"
#include "selvage/geometry/distance.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace selvage {
namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Pairs = std::vector<TrianglePair>;
using Keep = std::function<bool(Index, Index)>;

/// Each filter against a plain filter over the oracle's pairs.
class Filters : public testing::TestWithParam<surfaces::Family> {
 protected:
  void expect_kept(const Surface& surface, const PairFilters& filters, const Keep& keep, const char* name) {
    const TriangleMesh mesh = surface.mesh();
    for (const bool adjacent : {false, true}) {
      SelfCollisionOptions options;
      options.filters = filters;
      options.include_adjacent = adjacent;
      Pairs expected = oracle::meeting_pairs(surface, adjacent);
      all_ += expected.size();
      std::erase_if(expected, [&](const TrianglePair& p) { return !keep(p.first, p.second); });
      kept_ += expected.size();
      const SelfCollisionFinder finder(mesh, surface.positions, options);
      ASSERT_EQ(finder.find_pairs(), expected) << name;
      ASSERT_EQ(finder.has_pairs(), !expected.empty()) << name;
    }
  }

  std::size_t all_ = 0, kept_ = 0;
};
INSTANTIATE_TEST_SUITE_P(All, Filters, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(Filters, Groups) {
  Random random(1);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    PairFilters f;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) f.groups.push_back(random.below(4) - 1);
    expect_kept(
        surface, f, [&](Index i, Index j) { return f.groups[i] == kNone || f.groups[i] != f.groups[j]; }, "groups");
  }
}

TEST_P(Filters, LayersThatAreSeen) {
  Random random(2);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    PairFilters f;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      f.layers.push_back(1u << (31 * random.below(2)) | 1u << random.below(3));
      f.seen_layers.push_back(static_cast<std::uint32_t>(random.below(8)));
    }
    expect_kept(
        surface, f,
        [&](Index i, Index j) {
          return (f.layers[i] & f.seen_layers[j]) != 0 && (f.layers[j] & f.seen_layers[i]) != 0;
        },
        "seen layers");
    f.seen_layers.clear();
    expect_kept(
        surface, f, [&](Index i, Index j) { return (f.layers[i] & f.layers[j]) != 0; }, "common layers");
  }
}

TEST_P(Filters, Static) {
  Random random(3);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    PairFilters f;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      f.is_static.push_back(static_cast<std::uint8_t>(random.below(2) * 7));
    expect_kept(
        surface, f, [&](Index i, Index j) { return f.is_static[i] == 0 || f.is_static[j] == 0; }, "static");
  }
}

TEST_P(Filters, AllowedAndForbiddenPairs) {
  Random random(4);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    PairFilters f;
    // Every third pair of the oracle, in either order, and some that do not meet.
    for (const TrianglePair& p : oracle::meeting_pairs(surface, true)) {
      auto& list = random.below(2) == 0 ? f.allowed_pairs : f.forbidden_pairs;
      if (random.below(2) == 0) list.emplace_back(p.second, p.first);
      if (random.below(3) == 0) list.emplace_back(p.first, p.second);
    }
    const auto count = static_cast<Index>(surface.triangles.size());
    f.allowed_pairs.emplace_back(random.below(count), random.below(count));
    const auto lists = [](const std::vector<IndexPair>& pairs, Index i, Index j) {
      return std::count(pairs.begin(), pairs.end(), IndexPair(i, j)) +
                 std::count(pairs.begin(), pairs.end(), IndexPair(j, i)) >
             0;
    };
    expect_kept(
        surface, f, [&](Index i, Index j) { return lists(f.allowed_pairs, i, j) && !lists(f.forbidden_pairs, i, j); },
        "allowed and forbidden");
    f.allowed_pairs.clear();
    expect_kept(
        surface, f, [&](Index i, Index j) { return !lists(f.forbidden_pairs, i, j); }, "forbidden");
  }
}

/// Numbers of edges between vertices, by Floyd and Warshall.
std::vector<std::vector<int>> edge_distances(const Surface& surface) {
  const std::size_t count = surface.positions.size();
  std::vector<std::vector<int>> d(count, std::vector<int>(count, 1 << 20));
  for (std::size_t v = 0; v < count; ++v) d[v][v] = 0;
  for (const auto& t : surface.triangles)
    for (const Index v : t)
      for (const Index w : t)
        if (v != w) d[v][w] = 1;
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < count; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
  return d;
}

TEST_P(Filters, NeighbourRings) {
  Random random(5);
  for (std::int64_t n = 0; n < scaled(5); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    const auto distances = edge_distances(surface);
    for (const int rings : {1, 2, 4}) {
      PairFilters f;
      f.neighbour_rings = rings;
      expect_kept(
          surface, f,
          [&](Index i, Index j) {
            int nearest = 1 << 20;
            for (const Index v : surface.triangles[i])
              for (const Index w : surface.triangles[j]) nearest = std::min(nearest, distances[v][w]);
            return nearest > rings;
          },
          "rings");
    }
  }
}

std::array<Vec3, 3> corners(const std::vector<Vec3>& x, const VertexTuple<3>& t) {
  return {x[t[0]], x[t[1]], x[t[2]]};
}

/// The distance of two triangles to about 1e-3, by points on a fine grid of each.
double sampled_distance(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  static constexpr int kSteps = 12;
  const auto points = [](const std::array<Vec3, 3>& t) {
    std::vector<Vec3> list;
    for (int i = 0; i <= kSteps; ++i)
      for (int k = 0; i + k <= kSteps; ++k)
        list.push_back(t[0] + (t[1] - t[0]) * i / kSteps + (t[2] - t[0]) * k / kSteps);
    return list;
  };
  double best = HUGE_VAL;
  for (const Vec3& p : points(a))
    for (const Vec3& q : points(b)) best = std::min(best, (p - q).norm());
  return best;
}

TEST(Distance, OfTrianglesIsThatOfTheirNearestPoints) {
  Random random(6);
  for (std::int64_t n = 0; n < scaled(300); ++n) {
    std::array<std::array<Vec3, 3>, 2> t;
    for (auto& triangle : t)
      for (Vec3& x : triangle) x = Vec3(random.within(-1, 1), random.within(-1, 1), random.within(-1, 1));
    const Vec3 away(0, 0, random.below(3));
    for (Vec3& x : t[1]) x += away;
    if (n % 5 == 0) t[0][2] = t[0][1];
    if (n % 7 == 0) t[1][2] = t[1][1] = t[1][0];
    const double distance = std::sqrt(squared_distance(t[0], t[1])), sampled = sampled_distance(t[0], t[1]);
    ASSERT_LE(distance, sampled + 1e-12);
    ASSERT_GE(distance, sampled - 0.3);
    ASSERT_EQ(distance == 0, oracle::contact(t[0], t[1]) != TriangleContact::kDisjoint);
    ASSERT_NEAR(std::sqrt(squared_distance(t[1], t[0])), distance, 1e-12);
  }
}

TEST(Distance, ByHand) {
  const auto segment = [](double x, double y, double z, double u, double v, double w) {
    return std::array{Vec3(x, y, z), Vec3(u, v, w)};
  };
  EXPECT_EQ(squared_distance(segment(-1, 0, 0, 1, 0, 0), segment(0, -1, 2, 0, 1, 2)), 4);
  EXPECT_EQ(squared_distance(segment(-1, 0, 0, 1, 0, 0), segment(4, 0, 4, 9, 0, 4)), 25);
  EXPECT_EQ(squared_distance(segment(0, 0, 0, 4, 0, 0), segment(1, 1, 0, 2, 1, 0)), 1);
  EXPECT_EQ(squared_distance(segment(1, 0, 0, 1, 0, 0), segment(1, 3, 0, 1, 3, 0)), 9);
  EXPECT_EQ(squared_distance(segment(0, 0, 0, 2, 2, 0), segment(0, 2, 0, 2, 0, 0)), 0);
}

TEST_P(Filters, DistanceAtRest) {
  Random random(7);
  for (std::int64_t n = 0; n < scaled(10); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    PairFilters f;
    f.rest_positions = surfaces::jittered(surface, 1, random).positions;
    f.rest_distance = random.within(0.1, 1);
    expect_kept(
        surface, f,
        [&](Index i, Index j) {
          const auto a = corners(f.rest_positions, surface.triangles[i]),
                     b = corners(f.rest_positions, surface.triangles[j]);
          return std::sqrt(squared_distance(a, b)) >= f.rest_distance;
        },
        "rest");
  }
}

TEST_P(Filters, ThicknessFindsWhatIsNearerThanTheSum) {
  Random random(8);
  for (std::int64_t n = 0; n < scaled(20); ++n) {
    const Surface surface = surfaces::snapped(GetParam().make(random), 6);
    const TriangleMesh mesh = surface.mesh();
    SelfCollisionOptions options;
    for (std::size_t v = 0; v < surface.positions.size(); ++v)
      options.thickness.push_back(random.below(3) == 0 ? 0 : random.within(0, 0.4));
    const auto thickness = [&](Index t) {
      const auto& [a, b, c] = surface.triangles[t];
      return std::max({options.thickness[a], options.thickness[b], options.thickness[c]});
    };
    Pairs expected = oracle::meeting_pairs(surface, false);
    for (Index i = 0; i < mesh.triangle_count(); ++i)
      for (Index j = i + 1; j < mesh.triangle_count(); ++j) {
        const auto& t = surface.triangles[i];
        if (std::any_of(t.begin(), t.end(), [&](Index v) {
              return std::count(surface.triangles[j].begin(), surface.triangles[j].end(), v);
            }))
          continue;
        const double squared =
            squared_distance(corners(surface.positions, t), corners(surface.positions, surface.triangles[j]));
        if (squared > 0 && std::sqrt(squared) < thickness(i) + thickness(j))
          expected.push_back({i, j, TriangleContact::kDisjoint});
      }
    std::sort(expected.begin(), expected.end());
    SelfCollisionFinder finder(mesh, surface.positions, options);
    ASSERT_EQ(finder.find_pairs(), expected) << n;
    finder.update(surfaces::jittered(surface, 1, random).positions);
    finder.update(surface.positions);
    ASSERT_EQ(finder.find_pairs(), expected) << n;
  }
}

TEST(FiltersThat, DoNotFitAreRefused) {
  Random random(9);
  const Surface surface = surfaces::sheet(2, 2, random);
  const TriangleMesh mesh = surface.mesh();
  const auto refuses = [&](const std::function<void(SelfCollisionOptions&)>& change) {
    SelfCollisionOptions options;
    change(options);
    EXPECT_THROW(SelfCollisionFinder(mesh, surface.positions, options), Error);
  };
  refuses([](auto& o) { o.filters.groups = {1}; });
  refuses([](auto& o) { o.filters.layers = {1}; });
  refuses([](auto& o) { o.filters.seen_layers.assign(8, 1); });
  refuses([](auto& o) { o.filters.is_static = {1}; });
  refuses([](auto& o) { o.filters.allowed_pairs = {{0, 8}}; });
  refuses([](auto& o) { o.filters.forbidden_pairs = {{-1, 2}}; });
  refuses([](auto& o) { o.filters.neighbour_rings = -1; });
  refuses([](auto& o) { o.filters.rest_distance = 1; });
  refuses([](auto& o) { o.filters.rest_positions = {Vec3(0, 0, 0)}; });
  refuses([](auto& o) { o.thickness = {1}; });
  refuses([](auto& o) { o.thickness.assign(9, -1); });
}

}  // namespace
}  // namespace selvage
