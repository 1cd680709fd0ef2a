#include "simulation/colliders/collider_surface.h"

#include "random.h"
#include "selvage/geometry/distance.h"
#include "selvage/mesh/triangle_mesh.h"
#include "simulation/bodies.h"
#include "simulation/colliders/colliders.h"
#include "test_scale.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using namespace colliders;
using test::Random;

std::vector<PreparedCollider> prepared(auto shape) {
  return prepare_colliders(std::vector<Collider>{{.shape = std::move(shape)}});
}

/// Depth of a point in the shapes; negative outside of all.
double depth_in(std::span<const PreparedCollider> shapes, const Vec3& p) {
  double depth = -1;
  for (const PreparedCollider& collider : shapes)
    if (const auto hit = std::visit([&](const auto& shape) { return find_hit(shape, p); }, collider.shape))
      depth = std::max(depth, hit->depth);
  return depth;
}

Vec3 centroid(const ColliderSurface& surface, const VertexTuple<3>& t) {
  return (surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]]) / 3;
}
Vec3 area_normal(const ColliderSurface& surface, const VertexTuple<3>& t) {
  const auto& x = surface.positions;
  return (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
}

/// How many steps lead out of the shapes.
int steps_out(std::span<const PreparedCollider> shapes, const Vec3& from, const Vec3& step) {
  constexpr int kFarthest = 64;
  int steps = 0;
  while (steps < kFarthest && depth_in(shapes, from + steps * step) > 0) ++steps;
  return steps;
}

/// All points of the surface are inside the shapes, and no vertex is deeper than a bound; its triangles face outwards.
void expect_just_below(std::span<const PreparedCollider> shapes, const ColliderSurface& surface, double max_depth) {
  ASSERT_FALSE(surface.triangles.empty());
  ASSERT_EQ(surface.positions.size(), surface.collider_of_vertices.size());
  std::vector<std::uint8_t> is_used(surface.positions.size(), 0);
  for (const auto& t : surface.triangles) {
    for (const Vec3& p :
         {surface.positions[t[0]], surface.positions[t[1]], surface.positions[t[2]], centroid(surface, t)})
      EXPECT_GT(depth_in(shapes, p), 0) << p.transpose();
    for (const Index v : t) {
      is_used[v] = 1;
      EXPECT_LT(depth_in(shapes, surface.positions[v]), max_depth) << surface.positions[v].transpose();
    }
    const Vec3 normal = area_normal(surface, t);
    ASSERT_GT(normal.norm(), 0);
    const Vec3 step = max_depth / 32 * normal.normalized();
    EXPECT_LE(steps_out(shapes, centroid(surface, t), step), steps_out(shapes, centroid(surface, t), -step))
        << shapes[0].shape.index() << ' ' << centroid(surface, t).transpose() << " normal "
        << normal.normalized().transpose() << " depth " << max_depth;
  }
  EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
}

/// Distance of a point from the nearest edge of the surface, whose length is at most a bound.
double distance_from_edges(const ColliderSurface& surface, const Vec3& p, double max_length) {
  double nearest = HUGE_VAL;
  for (const auto& t : surface.triangles)
    for (int i = 0; i < 3; ++i) {
      const std::array<Vec3, 2> edge{surface.positions[t[i]], surface.positions[t[(i + 1) % 3]]};
      if ((edge[0] - edge[1]).norm() > max_length) continue;
      const Vec3 way = edge[1] - edge[0];
      const double place = std::clamp((p - edge[0]).dot(way) / way.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (edge[0] + place * way - p).norm());
    }
  return nearest;
}

TEST(ColliderSurface, PlanesContainersAndWideRoundSidesHaveNone) {
  const double size = 0.1;
  EXPECT_TRUE(make_collider_surface(prepared(PlaneShape{}), size).positions.empty());
  EXPECT_TRUE(make_collider_surface(prepared(BoxContainer{Vec3(0, 0, 0), Vec3(1, 1, 1)}), size).positions.empty());
  EXPECT_TRUE(make_collider_surface(prepared(SphereShape{Vec3(0, 0, 0), 1}), size).positions.empty());
  EXPECT_FALSE(make_collider_surface(prepared(SphereShape{Vec3(0, 0, 0), 0.1}), size).positions.empty());
  EXPECT_TRUE(make_collider_surface(prepared(SphereShape{Vec3(0, 0, 0), 0.1}), 0).positions.empty()) << "no body";
}

TEST(ColliderSurface, LiesJustBehindTheShape) {
  Random random(test::seed(1));
  for (std::int64_t n = 0; n < test::scaled(60, 10); ++n) {
    const double size = std::pow(10.0, random.within(-2, 0.3));
    const Vec3 centre = random.vector(2), axis = random.vector(1);
    const double radius = std::pow(10.0, random.within(-2, 0)), length = std::pow(10.0, random.within(-2, 0.5));
    const double bound = std::min(4 * 0.005 * size, std::min(radius, length));
    // A polygon cuts off a part of what is round.
    const double round = bound + 0.03 * size;
    const auto sphere = prepared(SphereShape{centre, radius});
    if (radius < 6 * size) expect_just_below(sphere, make_collider_surface(sphere, size), round);
    const auto cylinder = prepared(CylinderShape{centre, axis, radius, length});
    expect_just_below(cylinder, make_collider_surface(cylinder, size), round);
    const Vec3 extent(radius, length, random.within(0.1, 1));
    const auto box = prepared(solid_box(centre, centre + extent));
    expect_just_below(box, make_collider_surface(box, size), bound);
  }
}

TEST(ColliderSurface, OfABowlIsTheEdgeOfTheRim) {
  const auto bowl = prepared(Bowl{Vec3(0.1, 0.2, 0.3), Vec3(0.2, -0.1, 1), 1.5});
  const ColliderSurface surface = make_collider_surface(bowl, 0.2);
  for (const Vec3& p : surface.positions) EXPECT_GT(depth_in(bowl, p), 0);
  const auto& rim = std::get<Bowl>(bowl[0].shape);
  const Vec3 u = rim.axis.unitOrthogonal(), v = rim.axis.cross(u);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p = rim.centre + rim.radius * (std::cos(0.0628 * i) * u + std::sin(0.0628 * i) * v);
    EXPECT_LT(distance_from_edges(surface, p, 0.25), 0.02 * 0.2);
  }
}

TEST(ColliderSurface, FollowsTheEdgesOfABoxInPartsNoLongerThanAnElement) {
  const Vec3 lower(0, 0, 0), upper(3, 0.05, 1);
  const auto box = prepared(solid_box(lower, upper));
  const double size = 0.1;
  const ColliderSurface surface = make_collider_surface(box, size);
  for (const Vec3& p : edge_points(lower, upper, 50))
    EXPECT_LT(distance_from_edges(surface, p, 1.01 * size), 0.011 * size) << p.transpose();
}

TEST(ColliderSurface, StaysInsideAThinPlateAndANeedle) {
  for (const double thickness : {1e-3, 1e-6, 1e-9}) {
    const auto plate = prepared(solid_box({0, 0, 0}, {1, 1, thickness}));
    const ColliderSurface surface = make_collider_surface(plate, 0.2);
    for (const Vec3& p : surface.positions) {
      EXPECT_GE(p[2], 0);
      EXPECT_LE(p[2], thickness * (1 + 1e-12));
    }
    const auto needle = prepared(CylinderShape{Vec3(0, 0, 0), Vec3(0, 0, 1), thickness, 1});
    expect_just_below(needle, make_collider_surface(needle, 0.2), thickness);
  }
}

TEST(ColliderSurface, IsBoundedForTinyElements) {
  const auto wall = prepared(solid_box({0, 0, 0}, {1000, 1000, 1000}));
  EXPECT_LT(make_collider_surface(wall, 1e-5).positions.size(), 2'000'000U);
}

TEST(ColliderSurface, ElementSizeIsThatOfTheFinestBody) {
  const Model model =
      bodies::make(std::array{make_box(Vec3(1, 1, 1), 0.5), make_box(Vec3(1, 1, 1), 0.25)}, bodies::neo_hookean(1e5));
  const Model fine = bodies::make(make_box(Vec3(1, 1, 1), 0.25), bodies::neo_hookean(1e5));
  EXPECT_NEAR(element_size_of(model), element_size_of(fine), 1e-12);
  EXPECT_NEAR(element_size_of(fine), 0.31, 0.04) << "edges of cells, and diagonals";
}

}  // namespace
}  // namespace selvage
