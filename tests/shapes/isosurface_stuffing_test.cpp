#include "shapes/stuffing/isosurface_stuffing.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>
#include <random>
#include <string>

#include "mesh/mesh_checks.h"
#include "selvage/core/error.h"
#include "selvage/mesh/simplex_mesh.h"
#include "selvage/shapes/shapes.h"
#include "test_scale.h"

namespace selvage {
namespace {

using std::numbers::pi;

/// The bounds of the paper, for any surface: 10.78 and 164.74 degrees.
void expect_well_formed(const IndexedMesh& mesh) {
  EXPECT_EQ(test::count_not_positive(mesh), 0);
  EXPECT_EQ(test::count_orphans(mesh), 0);
  EXPECT_EQ(test::count_surface(mesh).bad_facets, 0);
  const test::AngleRange angles = test::dihedral_angles(mesh);
  EXPECT_GT(angles.smallest, 10.78);
  EXPECT_LT(angles.largest, 164.75);
}

TEST(IsosurfaceStuffing, BallsOfAllSizesKeepTheirAngles) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> size(0.6, 6);
  for (std::int64_t k = 0; k < test::scaled(60); ++k) {
    const double radius = size(random);
    SCOPED_TRACE(radius);
    const IndexedMesh ball = make_ball(radius, 1);
    expect_well_formed(ball);
    const test::SurfaceCount surface = test::count_surface(ball);
    EXPECT_EQ(surface.bad_boundary_edges, 0);
    EXPECT_EQ(surface.euler(), 2);
    EXPECT_EQ(test::count_components(ball), 1);
  }
}

TEST(IsosurfaceStuffing, VerticesInsideMoveFirst) {
  // In the order of their numbers, vertices of this ball would move so that an angle came to 9.6 degrees.
  expect_well_formed(make_ball(1.9745387211981407, 1));
}

TEST(IsosurfaceStuffing, BallBoundaryLiesOnTheSphere) {
  const IndexedMesh ball = make_ball(1, 0.15);
  EXPECT_NEAR(test::total_volume(ball), 4 * pi / 3, 0.02 * 4 * pi / 3);
  test::FacetUses<3> faces;
  for (const auto& [a, b, c, d] : ball.tetrahedra) {
    faces.add({b, c, d});
    faces.add({a, d, c});
    faces.add({a, b, d});
    faces.add({a, c, b});
  }
  faces.for_each([&](const VertexTuple<3>& face, int uses, int) {
    if (uses != 1) return;
    for (Index v : face) EXPECT_NEAR(ball.positions[v].norm(), 1, 1e-8);
  });
}

TEST(IsosurfaceStuffing, RandomSolidsKeepTheirAngles) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-3, 3), size(0.3, 1.5);
  for (std::int64_t k = 0; k < test::scaled(160); ++k) {
    SCOPED_TRACE(k);
    ImplicitSolid solid;
    for (int part = 0; part < 6; ++part) {
      solid.parts.push_back({{place(random), place(random), place(random)},
                             {place(random), place(random), place(random)},
                             size(random),
                             size(random)});
    }
    solid.body_count = 2;
    solid.blend = k % 2 == 0 ? 0.4 : 0;
    // Coarse against the radii: edges that the surface crosses twice, slivers of surface, creases.
    expect_well_formed(stuff_isosurface(solid, 0.45));
  }
}

TEST(IsosurfaceStuffing, LatticeVerticesOnTheSurface) {
  // Radii at which lattice vertices lie on the sphere exactly.
  for (const double radius : {1.0, 2.0, 3.0, 5.0}) {
    const IndexedMesh ball = make_ball(radius, 1);
    expect_well_formed(ball);
    EXPECT_EQ(test::count_surface(ball).euler(), 2);
  }
}

/// Vertices are spread evenly over the surface: before that, 2.4% of these edges were shorter than 0.4 cells.
TEST(IsosurfaceStuffing, ArmsAboutAsThickAsACellAreEven) {
  double short_edges = 0, edges = 0;
  for (int k = 0; k < 8; ++k) {
    ImplicitSolid arm;
    arm.parts.push_back({Vec3::Zero(), Vec3(9, 1 + k, 2 - k).normalized() * 9, 0.9, 0.9});
    arm.body_count = 1;
    const IndexedMesh mesh = stuff_isosurface(arm, 1);
    expect_well_formed(mesh);
    const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
    for (const Index v : solid.boundary_vertices()) EXPECT_NEAR(arm.parts[0].depth(mesh.positions[v]), 0, 1e-3);
    for (const auto& ridge : solid.boundary_ridges()) {
      const Vec3 &a = mesh.positions[ridge.vertices[0]], &b = mesh.positions[ridge.vertices[1]];
      short_edges += (a - b).norm() < 0.4;
      ++edges;
    }
  }
  EXPECT_LT(short_edges, 0.005 * edges);
}

TEST(IsosurfaceStuffing, SameBitsForAnyNumberOfThreads) {
  const IndexedMesh many = make_octopus(1, 0.06, 4);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const IndexedMesh alone = make_octopus(1, 0.06, 4);
  EXPECT_EQ(many.positions, alone.positions);
  EXPECT_EQ(many.tetrahedra, alone.tetrahedra);
}

TEST(IsosurfaceStuffing, DepthOfARoundConeIsThatOfItsBalls) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> place(-2, 2), size(0.05, 1);
  for (std::int64_t k = 0; k < test::scaled(300); ++k) {
    const RoundCone cone{{place(random), place(random), place(random)},
                         {place(random), place(random), place(random)},
                         size(random),
                         size(random)};
    const Vec3 p(2 * place(random), 2 * place(random), 2 * place(random));
    double deepest = -1e300;
    for (int i = 0; i <= 2000; ++i) {
      const double t = i / 2000.0;
      const double radius = (1 - t) * cone.begin_radius + t * cone.end_radius;
      deepest = std::max(deepest, radius - (p - (1 - t) * cone.begin - t * cone.end).norm());
    }
    EXPECT_NEAR(cone.depth(p), deepest, 1e-4);
  }
}

TEST(ImplicitShapes, OctopusHasEightArmsAndDoesNotTouchItself) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    SCOPED_TRACE(seed);
    const IndexedMesh octopus = make_octopus(1, 0.065, seed);
    expect_well_formed(octopus);
    EXPECT_EQ(test::count_components(octopus), 1);
    EXPECT_EQ(test::count_surface(octopus).euler(), 2);
    EXPECT_EQ(test::count_buried_vertices(octopus), 0);
    IndexedMesh arms = octopus;
    std::erase_if(arms.tetrahedra, [&](const VertexTuple<4>& t) {
      return std::any_of(t.begin(), t.end(), [&](Index v) { return octopus.positions[v].head<2>().norm() < 0.5; });
    });
    EXPECT_EQ(test::count_components(arms) - test::count_orphans(arms), 8);
  }
}

TEST(ImplicitShapes, SquishyBallHasAllItsTentacles) {
  const int tentacles = 60;
  const IndexedMesh ball = make_squishy_ball(1, tentacles, 0.08, 9);
  expect_well_formed(ball);
  EXPECT_EQ(test::count_components(ball), 1);
  EXPECT_EQ(test::count_surface(ball).euler(), 2);
  IndexedMesh outside = ball;
  std::erase_if(outside.tetrahedra, [&](const VertexTuple<4>& t) {
    return std::any_of(t.begin(), t.end(), [&](Index v) { return ball.positions[v].norm() < 1.1; });
  });
  EXPECT_EQ(test::count_components(outside) - test::count_orphans(outside), tentacles);
}

TEST(ImplicitShapes, SeedsDiffer) {
  EXPECT_EQ(make_octopus(1, 0.065, 1).positions, make_octopus(1, 0.065, 1).positions);
  EXPECT_NE(make_octopus(1, 0.065, 1).positions, make_octopus(1, 0.065, 2).positions);
  EXPECT_NE(make_squishy_ball(1, 20, 0.1, 1).positions, make_squishy_ball(1, 20, 0.1, 2).positions);
}

TEST(ImplicitShapes, RefuseBadArguments) {
  EXPECT_THROW(make_ball(0, 1), Error);
  EXPECT_THROW(make_ball(1, -1), Error);
  EXPECT_THROW(make_ball(1, 1e-4), Error);
  EXPECT_THROW(make_ball(1, 1e-300), Error);
  EXPECT_THROW(make_octopus(1, 0.2, 1), Error);
  EXPECT_THROW(make_octopus(1, 1e-4, 1), Error);
  EXPECT_THROW(make_squishy_ball(1, 0, 0.1, 1), Error);
  EXPECT_THROW(make_squishy_ball(1, 300, 0.2, 1), Error);
  try {
    make_ball(1, 1e-4);
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("2^29"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace selvage
