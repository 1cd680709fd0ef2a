#include "selvage/surface_distance/surface_distance.h"

#include "self_collision/surfaces.h"
#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "test_scale.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <type_traits>

namespace selvage {

namespace {

using surfaces::Surface;
using test::Random;
using test::scaled;
using Positions = std::vector<Vec3>;

static_assert(!std::is_constructible_v<SurfaceDistance, TriangleMesh, std::span<const Vec3>>);
static_assert(std::is_constructible_v<SurfaceDistance, const TriangleMesh&, std::span<const Vec3>>);

/// Every triangle, one by one.
SurfacePoint closest_of_all(const TriangleMesh& mesh, const Positions& x, const Vec3& p) {
  SurfacePoint best;
  double smallest = std::numeric_limits<double>::infinity();
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.triangles()[t];
    const auto closest = closest_point_on_triangle(p, x[a], x[b], x[c]);
    if (!(closest.squared_distance < smallest)) continue;
    smallest = closest.squared_distance;
    best.triangle = t;
    best.barycentric = closest.barycentric;
    best.point = closest.point;
    best.distance = std::sqrt(closest.squared_distance);
  }
  return best;
}

/// The solid angle of the surface as seen from a point off it, over 4 pi (van Oosterom, Strackee 1983).
double winding_by_solid_angles(const TriangleMesh& mesh, const Positions& x, const Vec3& p) {
  double sum = 0;
  for (const auto& t : mesh.triangles()) {
    const Vec3 a = x[t[0]] - p, b = x[t[1]] - p, c = x[t[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

/// Points around a surface, and on its vertices, and as far from them as others are.
Positions points_around(const Surface& surface, int count, Random& random) {
  Vec3 lower = surface.positions[0], upper = lower;
  for (const Vec3& x : surface.positions) {
    lower = lower.cwiseMin(x);
    upper = upper.cwiseMax(x);
  }
  Positions points;
  for (int i = 0; i < count; ++i) {
    const double reach = i % 5 == 0 ? 10 : 0.7;
    points.push_back((lower + upper) / 2 + ((upper - lower).array() * random.vector(reach).array()).matrix());
    if (i % 4 == 0) points.push_back(surface.positions[random.below(surface.positions.size())]);
    if (i % 4 == 1)  // straight below or above a vertex: the ray passes through it
      points.push_back(surface.positions[random.below(surface.positions.size())] + Vec3(0, 0, random.within(-2, 2)));
    if (i % 4 == 2) points.push_back(Vec3(random.below(5), random.below(5), random.below(5)));
  }
  return points;
}

class SurfaceDistanceOf : public testing::TestWithParam<surfaces::Family> {};
INSTANTIATE_TEST_SUITE_P(All, SurfaceDistanceOf, testing::ValuesIn(surfaces::families()), surfaces::name_of);

TEST_P(SurfaceDistanceOf, ClosestPointIsThatOfAllTriangles) {
  Random random(41);
  for (std::int64_t n = 0; n < scaled(20); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    const Positions points = points_around(surface, 20, random);
    const auto found = SurfaceDistance(mesh, surface.positions).find_closest_points(points);
    ASSERT_EQ(found.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SurfacePoint expected = closest_of_all(mesh, surface.positions, points[i]);
      ASSERT_EQ(found[i].triangle, expected.triangle) << n << " " << i;
      ASSERT_EQ(found[i].barycentric, expected.barycentric);
      ASSERT_EQ(found[i].point, expected.point);
      ASSERT_EQ(found[i].distance, expected.distance);
    }
  }
}

TEST_P(SurfaceDistanceOf, FeatureIsWhatHasNoWeightElsewhere) {
  Random random(42);
  int features[3] = {};
  for (std::int64_t n = 0; n < scaled(20); ++n) {
    const Surface surface = GetParam().make(random);
    const TriangleMesh mesh = surface.mesh();
    for (const SurfacePoint& found :
         SurfaceDistance(mesh, surface.positions).find_closest_points(points_around(surface, 20, random))) {
      ++features[static_cast<int>(found.feature)];
      std::vector<Index> vertices;
      if (found.feature == SurfaceFeature::kFace) {
        ASSERT_EQ(found.feature_index, found.triangle);
        continue;
      }
      if (found.feature == SurfaceFeature::kVertex)
        vertices = {found.feature_index};
      else
        vertices.assign(mesh.edges()[found.feature_index].begin(), mesh.edges()[found.feature_index].end());
      for (int k = 0; k < 3; ++k) {
        const Index v = mesh.triangles()[found.triangle][k];
        if (!surfaces::has_vertex(vertices, v)) {
          ASSERT_EQ(found.barycentric[k], 0);
        }
      }
    }
  }
  EXPECT_GT(features[1] + features[2], 0);
}

/// Closed surfaces: balls crumpled, turned inside out, in each other and through each other, on lattices.
Surface closed_surface(std::int64_t kind, Random& random) {
  const auto& families = surfaces::families();
  const auto closed = std::find_if(families.begin(), families.end(), [](const auto& f) { return f.name == "closed"; });
  Surface surface = closed->make(random);
  if (kind % 4 >= 1) {
    Surface other = closed->make(random);
    const double scale = kind % 4 == 2 ? 0.3 : 1;  // a hole, or a core
    for (Vec3& x : other.positions) x = scale * x + (kind % 4 == 3 ? random.vector(1) : Vec3(0, 0, 0));
    if (random.below(2) == 0)
      for (auto& t : other.triangles) std::swap(t[0], t[1]);
    surface = surfaces::together(surface, other);
  }
  for (Vec3& x : surface.positions) x *= 2;
  return kind % 3 == 0 ? surfaces::snapped(surface, 1) : surface;
}

TEST(SurfaceSides, AreTheSolidAngleWherePointsAreOffTheSurface) {
  Random random(43);
  std::int64_t asked = 0, inside = 0, on_surface = 0, twice = 0, inverted = 0;
  for (std::int64_t n = 0; n < scaled(120, 40); ++n) {
    const Surface surface = closed_surface(n, random);
    const TriangleMesh mesh = surface.mesh();
    const SurfaceDistance distance(mesh, surface.positions);
    ASSERT_TRUE(distance.is_closed());
    Positions points = points_around(surface, 20, random);
    for (Vec3& p : points)
      if (n % 3 == 0 && random.below(2) == 0) p = (2 * p).array().round() / 2;  // the ray meets edges and vertices
    const auto found = distance.find_signed_distances(points);
    ASSERT_EQ(found.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SignedDistance& f = found[i];
      on_surface += f.side.is_on_surface;
      if (f.side.is_on_surface) {
        ASSERT_EQ(f.distance, 0);
        ASSERT_LT(f.closest.distance, 1e-14);
        continue;
      }
      ASSERT_EQ(f.distance, f.side.winding_number != 0 ? -f.closest.distance : f.closest.distance);
      if (f.closest.distance < 1e-6) continue;  // the solid angle is rounded
      ++asked;
      const double winding = winding_by_solid_angles(mesh, surface.positions, points[i]);
      ASSERT_NEAR(f.side.winding_number, winding, 1e-3) << n << " " << i;
      inside += f.side.winding_number == 1;
      twice += f.side.winding_number == 2;
      inverted += f.side.winding_number == -1;
    }
  }
  EXPECT_GT(inside, asked / 20);
  EXPECT_GT(on_surface, 0);
  EXPECT_GT(twice, 0);
  EXPECT_GT(inverted, 0);
}

/// A cube of side 2 around the origin, its normals outward.
Surface cube() {
  Surface surface;
  for (int i = 0; i < 8; ++i)
    surface.positions.emplace_back((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  surface.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                       {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return surface;
}

TEST(SurfaceDistanceByHand, Cube) {
  const Surface surface = cube();
  const TriangleMesh mesh = surface.mesh();
  const SurfaceDistance distance(mesh, surface.positions);
  const Positions points{{0.25, 0, 0}, {0, 0, 3}, {1, 1, 1}, {1, 0.5, 0.25}, {3, 3, 1}, {0, 0, -5}};
  const auto found = distance.find_signed_distances(points);
  EXPECT_EQ(found[0].distance, -0.75);
  EXPECT_EQ(found[0].closest.point, Vec3(1, 0, 0));
  EXPECT_EQ(found[1].distance, 2);
  EXPECT_EQ(found[2].distance, 0);
  EXPECT_TRUE(found[2].side.is_on_surface);
  EXPECT_EQ(found[2].closest.feature, SurfaceFeature::kVertex);
  EXPECT_EQ(found[2].closest.feature_index, 7);
  EXPECT_EQ(found[3].distance, 0);
  EXPECT_EQ(found[4].closest.feature, SurfaceFeature::kVertex);
  EXPECT_EQ(found[4].distance, std::sqrt(8.0));
  EXPECT_EQ(found[5].side, SurfaceSide{});
}

TEST(SurfaceDistanceByHand, ATinyStepDecidesTheSide) {
  const Surface surface = cube();
  const TriangleMesh mesh = surface.mesh();
  const SurfaceDistance distance(mesh, surface.positions);
  const double below = std::nextafter(1.0, 0.0), above = std::nextafter(1.0, 2.0);
  const auto sides = distance.find_sides(Positions{{0.1, 0.2, below}, {0.1, 0.2, 1}, {0.1, 0.2, above}});
  EXPECT_EQ(sides[0].winding_number, 1);
  EXPECT_TRUE(sides[1].is_on_surface);
  EXPECT_EQ(sides[2].winding_number, 0);
}

TEST(SurfaceDistanceByHand, AnOpenSurfaceHasNoInside) {
  Surface surface = cube();
  surface.triangles.pop_back();
  const TriangleMesh mesh = surface.mesh();
  const SurfaceDistance distance(mesh, surface.positions);
  EXPECT_FALSE(distance.is_closed());
  EXPECT_EQ(distance.find_closest_points(Positions{{0, 0, 0.5}})[0].distance, 0.5);
  EXPECT_THROW(distance.find_sides(Positions{{0, 0, 0}}), Error);
  EXPECT_THROW(distance.find_signed_distances(Positions{{0, 0, 0}}), Error);
}

TEST(SurfaceDistanceByHand, OneTriangleTurnedOverIsNotClosed) {
  Surface surface = cube();
  std::swap(surface.triangles[3][0], surface.triangles[3][1]);
  const TriangleMesh mesh = surface.mesh();
  EXPECT_FALSE(SurfaceDistance(mesh, surface.positions).is_closed());
}

TEST(SurfaceDistanceByHand, CubesThatShareAnEdge) {
  Surface surface = cube();
  const Surface other = cube();
  // The edge from vertex 6 to 7 of one is that from 0 to 1 of the other: four triangles run along it.
  std::vector<Index> number(8);
  for (Index v = 0; v < 8; ++v) {
    number[v] = v < 2 ? 6 + v : static_cast<Index>(surface.positions.size());
    if (v >= 2) surface.positions.push_back(other.positions[v] + Vec3(0, 2, 2));
  }
  for (const auto& [a, b, c] : other.triangles) surface.triangles.push_back({number[a], number[b], number[c]});
  const TriangleMesh mesh = surface.mesh();
  const SurfaceDistance distance(mesh, surface.positions);
  ASSERT_TRUE(distance.is_closed());
  const auto found =
      distance.find_signed_distances(Positions{{0, 0.9, 0.9}, {0, 1.1, 1.1}, {0, 0.9, 1.1}, {0, 1.1, 0.9}, {0, 1, 1}});
  EXPECT_NEAR(found[0].distance, -0.1, 1e-15);
  EXPECT_NEAR(found[1].distance, -0.1, 1e-15);
  EXPECT_NEAR(found[2].distance, 0.1, 1e-15);
  EXPECT_NEAR(found[3].distance, 0.1, 1e-15);
  EXPECT_TRUE(found[4].side.is_on_surface);
}

TEST(SurfaceDistanceByHand, CoordinatesOfAnyMagnitudeUpToTheLimit) {
  const Surface unit = cube();
  const TriangleMesh mesh = unit.mesh();
  for (const double scale : {1e-140, 1e-30, 1e30, 1e149}) {
    Surface surface = unit;
    for (Vec3& x : surface.positions) x *= scale;
    const SurfaceDistance distance(mesh, surface.positions);
    const auto found = distance.find_signed_distances(Positions{scale * Vec3(0.25, 0, 0), scale * Vec3(0, 0, 3)});
    EXPECT_NEAR(found[0].distance / scale, -0.75, 1e-12) << scale;
    EXPECT_NEAR(found[1].distance / scale, 2, 1e-12) << scale;
  }
}

TEST(SurfaceDistanceByHand, UpdateGivesWhatANewObjectGives) {
  Random random(44);
  const Surface sheet = surfaces::sheet(20, 20, random);
  const TriangleMesh mesh = sheet.mesh();
  SurfaceDistance distance(mesh, sheet.positions);
  for (const double amount : {0.1, 1.0, 30.0}) {
    const Surface moved = surfaces::jittered(sheet, amount, random);
    distance.update(moved.positions);
    const Positions points = points_around(moved, 50, random);
    const auto found = distance.find_closest_points(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const SurfacePoint expected = closest_of_all(mesh, moved.positions, points[i]);
      ASSERT_EQ(found[i].triangle, expected.triangle);
      ASSERT_EQ(found[i].point, expected.point);
    }
  }
}

TEST(SurfaceDistanceByHand, SameBitsForAnyNumberOfThreads) {
  Random random(45);
  const Surface surface = closed_surface(1, random);
  const TriangleMesh mesh = surface.mesh();
  const SurfaceDistance distance(mesh, surface.positions);
  const Positions points = points_around(surface, 2000, random);
  test::same_for_any_threads([&] {
    std::vector<std::array<std::uint64_t, 4>> bits;
    for (const SignedDistance& f : distance.find_signed_distances(points))
      bits.push_back({std::bit_cast<std::uint64_t>(f.distance), std::bit_cast<std::uint64_t>(f.closest.point[0]),
                      static_cast<std::uint64_t>(f.closest.triangle),
                      static_cast<std::uint64_t>(f.side.winding_number)});
    return bits;
  });
}

TEST(SurfaceDistanceByHand, RefusesBadInput) {
  const Surface surface = cube();
  const TriangleMesh mesh = surface.mesh(), empty;
  EXPECT_THROW(SurfaceDistance(empty, Positions{}), Error);
  EXPECT_THROW(SurfaceDistance(mesh, std::span(surface.positions).first(7)), Error);
  Positions broken = surface.positions;
  broken[3][1] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(SurfaceDistance(mesh, broken), Error);
  broken[3][1] = 1e151;
  EXPECT_THROW(SurfaceDistance(mesh, broken), Error);
  SurfaceDistance distance(mesh, surface.positions);
  EXPECT_THROW(distance.update(broken), Error);
  EXPECT_THROW(distance.find_closest_points(Positions{{0, std::numeric_limits<double>::quiet_NaN(), 0}}), Error);
  EXPECT_TRUE(distance.find_closest_points({}).empty());
}

}  // namespace
}  // namespace selvage
