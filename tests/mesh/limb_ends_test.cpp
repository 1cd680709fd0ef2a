#include "mesh/limb_ends.h"

#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace selvage {
namespace {

struct Solid {
  IndexedMesh file;
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};

  template <typename Which>
  std::vector<Index> region_of(const Which& is_in, Index name = 0) const {
    std::vector<Index> regions;
    for (const Vec3& x : file.positions) regions.push_back(is_in(x) ? name : kNone);
    return regions;
  }

  template <typename Which>
  std::int64_t count(const Which& is_in) const {
    return std::count_if(file.positions.begin(), file.positions.end(), is_in);
  }
};

Solid bar() {
  return {make_box({4, 1, 1}, 0.25)};
}

TEST(LimbEnds, AreTheShorterOfTwo) {
  const Solid b = bar();
  for (const double middle : {1.0, 3.0}) {
    const auto is_in = [&](const Vec3& x) { return std::abs(x[0] - middle) < 0.2; };
    const auto ends = find_limb_ends(b.mesh, b.file.positions, b.region_of(is_in, 7));
    ASSERT_EQ(ends.size(), 1u);
    const LimbEnd& end = ends.at(7);
    EXPECT_EQ(end.vertices,
              b.count([&](const Vec3& x) { return !is_in(x) && (middle < 2 ? x[0] < middle : x[0] > middle); }));
    EXPECT_NEAR(end.way.norm(), 1, 1e-12);
    EXPECT_GT(end.way[0] * (middle < 2 ? 1 : -1), 0.9);
  }
}

TEST(LimbEnds, ArePartedByAWholeCutAlone) {
  const Solid b = bar();
  const auto notch = b.region_of([](const Vec3& x) { return std::abs(x[0] - 1) < 0.2 && x[1] < 0.9; });
  EXPECT_TRUE(find_limb_ends(b.mesh, b.file.positions, notch).empty());
  const auto end = b.region_of([](const Vec3& x) { return x[0] < 0.2; });
  EXPECT_TRUE(find_limb_ends(b.mesh, b.file.positions, end).empty());
  EXPECT_TRUE(find_limb_ends(b.mesh, b.file.positions, b.region_of([](const Vec3&) { return false; })).empty());
  EXPECT_TRUE(find_limb_ends(b.mesh, b.file.positions, b.region_of([](const Vec3&) { return true; })).empty());
}

// A limb goes on behind what else cuts it.
TEST(LimbEnds, ReachAcrossOtherRegions) {
  const Solid b = bar();
  std::vector<Index> regions = b.region_of([](const Vec3& x) { return std::abs(x[0] - 0.5) < 0.2; }, 3);
  for (std::size_t v = 0; v < regions.size(); ++v)
    if (std::abs(b.file.positions[v][0] - 1.5) < 0.2) regions[v] = 1;
  const auto ends = find_limb_ends(b.mesh, b.file.positions, regions);
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends.at(3).vertices, b.count([](const Vec3& x) { return x[0] < 0.3; }));
  EXPECT_EQ(ends.at(1).vertices, b.count([](const Vec3& x) { return x[0] < 1.3; }));
  EXPECT_GT(ends.at(1).way[0], 0.9);
}

TEST(LimbEnds, AreNotVerticesInBetweenThoseOfTheRegion) {
  const Solid b = bar();
  std::vector<Index> regions = b.region_of([](const Vec3& x) { return std::abs(x[0] - 1) < 0.4; });
  for (std::size_t v = 0; v < regions.size(); ++v)
    if ((b.file.positions[v] - Vec3(1, 0.5, 0.5)).norm() < 0.1) regions[v] = kNone;
  EXPECT_EQ(find_limb_ends(b.mesh, b.file.positions, regions).at(0).vertices,
            b.count([](const Vec3& x) { return x[0] < 0.6; }));
}

TEST(LimbEnds, AreNotStubs) {
  const Solid b = bar();
  for (const double to : {0.3, 0.6, 0.8}) {
    const auto regions = b.region_of([&](const Vec3& x) { return x[0] > 0.1 && x[0] < to; });
    const auto ends = find_limb_ends(b.mesh, b.file.positions, regions);
    // One plane of vertices before one, two or three.
    EXPECT_EQ(ends.size(), to < 0.7 ? 1u : 0u) << to;
  }
}

// A ring falls apart where it is cut twice; by one cut it is opened.
TEST(LimbEnds, AreNotOfARing) {
  const Solid torus{make_torus(1, 0.3, 0.15)};
  const auto once = torus.region_of([](const Vec3& x) { return x[0] > 0 && std::abs(x[1]) < 0.2; });
  EXPECT_TRUE(find_limb_ends(torus.mesh, torus.file.positions, once).empty());
  const auto is_in = [](const Vec3& x) { return std::abs(x[1] - 0.3) < 0.2; };
  const auto twice = find_limb_ends(torus.mesh, torus.file.positions, torus.region_of(is_in));
  ASSERT_EQ(twice.size(), 1u);
  EXPECT_EQ(twice.at(0).vertices, torus.count([&](const Vec3& x) { return x[1] >= 0.5; }));
  EXPECT_LT(twice.at(0).way[1], -0.9);
}

}  // namespace
}  // namespace selvage
