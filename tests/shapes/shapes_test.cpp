#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <string>

#include "mesh/mesh_checks.h"
#include "selvage/core/error.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {
namespace {

/// One family of meshes, with what its making promises.
struct ShapeCase {
  std::string name;
  IndexedMesh mesh;
  double volume;            ///< expected, of the smooth shape [m^3]
  double volume_tolerance;  ///< relative
  std::int64_t euler;       ///< of the boundary: 2 for a ball, 0 for a torus
  double smallest_angle;    ///< promised dihedral angles [degrees]
  double largest_angle;
};

std::vector<ShapeCase> structured_shapes() {
  using std::numbers::pi;
  std::vector<ShapeCase> cases;
  cases.push_back({"box", make_box({1, 2, 0.5}, 0.13), 1, 1e-12, 2, 40, 100});
  cases.push_back({"box of one cell", make_box({1, 1, 1}, 5), 1, 1e-12, 2, 44.99, 90.01});
  cases.push_back({"tube", make_tube(1, 0.6, 2, 0.15), pi * (1 - 0.36) * 2, 0.01, 0, 25, 130});
  cases.push_back(
      {"gear", make_gear(1, 0.3, 0.4, 12, 0.08), 0.4 * (pi * (0.839 * 0.839 - 0.09) - 0.03), 0.05, 0, 7, 160});
  cases.push_back(
      {"coarse gear", make_gear(1, 0.3, 0.4, 12, 9), 0.4 * (pi * (0.839 * 0.839 - 0.09) - 0.03), 0.1, 0, 7, 160});
  cases.push_back({"torus", make_torus(1, 0.3, 0.1), 2 * pi * pi * 0.09, 0.03, 0, 20, 140});
  cases.push_back({"rod", make_rod(RodCurve::kStraight, 3, 0.2, 0.07), 3 * pi * 0.04, 0.03, 2, 25, 130});
  cases.push_back({"trefoil", make_rod(RodCurve::kTrefoil, 20, 0.2, 0.1), 20 * pi * 0.04, 0.06, 0, 20, 140});
  cases.push_back({"nested knot", make_rod(RodCurve::kNestedKnot, 60, 0.2, 0.1), 60 * pi * 0.04, 0.06, 0, 15, 145});
  cases.push_back({"overhand", make_rod(RodCurve::kOverhand, 30, 0.3, 0.1), 30 * pi * 0.09, 0.06, 2, 15, 150});
  cases.push_back(
      {"nested overhand", make_rod(RodCurve::kNestedOverhand, 100, 0.25, 0.12), 100 * pi * 0.0625, 0.06, 2, 15, 150});
  cases.push_back({"noodle", make_rod(RodCurve::kCoil, 30, 0.1, 0.05), 30 * pi * 0.01, 0.06, 2, 15, 145});
  // As coarse as they get: a hexagon, a ring of twelve cells, and few of them along the coil.
  cases.push_back({"coarse tube", make_tube(0.3, 0.25, 4, 9), pi * 0.0275 * 4, 0.05, 0, 8, 145});
  cases.push_back({"coarse torus", make_torus(1, 0.05, 9), 2 * pi * pi * 0.0025, 0.3, 0, 8, 145});
  cases.push_back({"coarse rod", make_rod(RodCurve::kStraight, 3, 0.2, 9), 3 * pi * 0.04, 0.2, 2, 8, 145});
  cases.push_back({"coarse overhand", make_rod(RodCurve::kOverhand, 30, 0.25, 9), 30 * pi * 0.0625, 0.2, 2, 8, 150});
  cases.push_back(
      {"coarse nested overhand", make_rod(RodCurve::kNestedOverhand, 120, 0.25, 9), 120 * pi * 0.0625, 0.2, 2, 8, 150});
  cases.push_back({"coarse noodle", make_rod(RodCurve::kCoil, 60, 0.1, 9), 60 * pi * 0.01, 0.45, 2, 8, 145});
  return cases;
}

TEST(Shapes, AreConformingPositiveAndWellShaped) {
  for (const ShapeCase& c : structured_shapes()) {
    SCOPED_TRACE(c.name);
    EXPECT_GT(c.mesh.tetrahedra.size(), 0u);
    EXPECT_EQ(test::count_not_positive(c.mesh), 0);
    EXPECT_EQ(test::count_orphans(c.mesh), 0);
    EXPECT_EQ(test::count_components(c.mesh), 1);
    const test::SurfaceCount surface = test::count_surface(c.mesh);
    EXPECT_EQ(surface.bad_facets, 0);
    EXPECT_EQ(surface.bad_boundary_edges, 0);
    EXPECT_EQ(surface.euler(), c.euler);
    EXPECT_NEAR(test::total_volume(c.mesh), c.volume, c.volume * c.volume_tolerance);
    const test::AngleRange angles = test::dihedral_angles(c.mesh);
    EXPECT_GT(angles.smallest, c.smallest_angle);
    EXPECT_LT(angles.largest, c.largest_angle);
  }
}

TEST(Shapes, DoNotTouchThemselvesAtRest) {
  for (const ShapeCase& c : structured_shapes()) {
    EXPECT_EQ(test::count_buried_vertices(c.mesh), 0) << c.name;
  }
}

TEST(Shapes, BoxEndsExactlyAtItsSize) {
  const Vec3 size(0.1, 0.7, 1.3);
  Vec3 low = Vec3::Ones(), high = -Vec3::Ones();
  for (const Vec3& p : make_box(size, 0.09).positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  EXPECT_EQ(low, Vec3(0, 0, 0));
  EXPECT_EQ(high, size);
}

TEST(Shapes, SleeveIsAnOpenTubeThatFacesOutwards) {
  const IndexedMesh sleeve = make_sleeve(0.1, 0.5, 0.02);
  const TriangleMesh mesh(static_cast<Index>(sleeve.positions.size()), sleeve.triangles);
  EXPECT_TRUE(mesh.is_oriented());
  EXPECT_EQ(test::count_orphans(sleeve), 0);
  Index border = 0;
  for (Index e = 0; e < mesh.edge_count(); ++e) border += mesh.edge_triangles(e).size() == 1;
  EXPECT_EQ(border, 2 * 31);  // round the ends
  double area = 0;
  for (const auto& t : sleeve.triangles) {
    const Vec3& p = sleeve.positions[t[0]];
    const Vec3 normal = (sleeve.positions[t[1]] - p).cross(sleeve.positions[t[2]] - p);
    EXPECT_GT(normal.dot(Vec3(p[0], p[1], 0)), 0);
    area += normal.norm() / 2;
  }
  EXPECT_NEAR(area, 2 * pi * 0.1 * 0.5, 0.01 * area);
  EXPECT_EQ(make_sleeve(0.1, 0.5, 9).triangles.size(), 12u);
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(make_sleeve(bad, 1, 0.1), Error);
    EXPECT_THROW(make_sleeve(1, bad, 0.1), Error);
    EXPECT_THROW(make_sleeve(1, 1, bad), Error);
  }
  EXPECT_THROW(make_sleeve(1, 1, 1e-5), Error);
}

TEST(Shapes, ClothIsAFlatManifoldSheet) {
  const IndexedMesh cloth = make_cloth(2, 1, 0.25);
  EXPECT_EQ(cloth.triangles.size(), 64u);
  EXPECT_TRUE(cloth.tetrahedra.empty());
  EXPECT_EQ(test::count_orphans(cloth), 0);
  test::FacetUses<2> edges;
  double area = 0;
  for (const auto& t : cloth.triangles) {
    for (int i = 0; i < 3; ++i) edges.add({t[i], t[(i + 1) % 3]});
    const Vec3 normal =
        (cloth.positions[t[1]] - cloth.positions[t[0]]).cross(Vec3(cloth.positions[t[2]] - cloth.positions[t[0]]));
    EXPECT_GT(normal[2], 0);
    area += normal.norm() / 2;
  }
  EXPECT_DOUBLE_EQ(area, 2);
  std::int64_t border = 0;
  edges.for_each([&](const VertexTuple<2>&, int uses, int sum) {
    EXPECT_TRUE(uses == 1 || (uses == 2 && sum == 0));
    border += uses == 1;
  });
  EXPECT_EQ(border, 24);
}

TEST(Shapes, KnotsAreKnotted) {
  // The writhe of the centre line, Gauss's integral over all pairs of segments, tells a knot from a plain ring:
  // about 3.4 for a trefoil, near 0 for a ring.
  const IndexedMesh trefoil = make_rod(RodCurve::kTrefoil, 20, 0.2, 0.2);
  const std::size_t per_section = 7, n = trefoil.positions.size() / per_section;
  double writhe = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      const auto point = [&](std::size_t k) { return trefoil.positions[k % n * per_section]; };
      const Vec3 a = point(i + 1) - point(i), b = point(j + 1) - point(j);
      const Vec3 apart = (point(i) + point(i + 1) - point(j) - point(j + 1)) / 2;
      writhe += a.cross(b).dot(apart) / std::pow(apart.norm(), 3) / (4 * std::numbers::pi);
    }
  }
  EXPECT_GT(std::abs(writhe), 2.5);
  EXPECT_LT(std::abs(writhe), 4.5);
}

TEST(Shapes, ConcatenateKeepsOrder) {
  const std::vector<IndexedMesh> parts = {make_box({1, 1, 1}, 1), make_cloth(1, 1, 1), make_box({2, 2, 2}, 2)};
  const IndexedMesh all = concatenate(parts);
  EXPECT_EQ(all.positions.size(), 8u + 4u + 8u);
  EXPECT_EQ(all.tetrahedra.size(), 12u);
  EXPECT_EQ(all.triangles.size(), 2u);
  EXPECT_EQ(all.tetrahedra[0], parts[0].tetrahedra[0]);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(all.tetrahedra[6][i], parts[2].tetrahedra[0][i] + 12);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(all.triangles[1][i], parts[1].triangles[1][i] + 8);
  EXPECT_EQ(all.positions[19], Vec3(2, 2, 2));
}

TEST(Shapes, RefuseBadArgumentsInOneLine) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    EXPECT_THROW(make_box({1, 1, 1}, bad), Error);
    EXPECT_THROW(make_box({1, bad, 1}, 0.1), Error);
    EXPECT_THROW(make_tube(bad, 0.5, 1, 0.1), Error);
    EXPECT_THROW(make_tube(1, 0.5, bad, 0.1), Error);
    EXPECT_THROW(make_torus(bad, 0.1, 0.1), Error);
    EXPECT_THROW(make_rod(RodCurve::kTrefoil, bad, 0.1, 0.1), Error);
    EXPECT_THROW(make_rod(RodCurve::kCoil, 10, bad, 0.1), Error);
    EXPECT_THROW(make_cloth(1, 1, bad), Error);
  }
  EXPECT_THROW(make_tube(1, 1, 1, 0.1), Error);
  EXPECT_THROW(make_torus(1, 1, 0.1), Error);
  try {
    make_rod(RodCurve::kTrefoil, 20, 1.5, 0.1);
    FAIL() << "a trefoil that touches itself";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("touch itself"), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

TEST(Shapes, RefuseMoreElementsThanCanBeIndexed) {
  const auto expect_refusal = [](auto&& make) {
    try {
      make();
      FAIL() << "made";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("2^29"), std::string::npos) << error.what();
    }
  };
  expect_refusal([] { return make_box({1, 1, 1}, 1e-3); });
  expect_refusal([] { return make_box({1, 1e300, 1}, 1e-3); });
  expect_refusal([] { return make_tube(1, 0.5, 1, 1e-4); });
  expect_refusal([] { return make_torus(1, 0.5, 1e-4); });
  expect_refusal([] { return make_rod(RodCurve::kCoil, 1, 0.1, 1e-5); });
  expect_refusal([] { return make_cloth(1, 1, 1e-5); });
}

}  // namespace
}  // namespace selvage
