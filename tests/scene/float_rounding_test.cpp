#include "scene/float_rounding.h"

#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace selvage {
namespace {

/// Wavy sheets of the same form, one above the other by the gap, far from the origin so that floats are coarse. A third
/// one rises from where it touches the second along a line.
struct Sheets {
  IndexedMesh file = make_cloth(1, 1, 0.1);
  std::vector<Vec3> positions;
  TriangleMesh mesh;

  explicit Sheets(double gap, int count = 2) : mesh(surface(count)) {
    for (int sheet = 0; sheet < count; ++sheet)
      for (const Vec3& p : file.positions)
        positions.push_back({p[0] + 3, p[1] - 5,
                             0.1 * std::sin(5 * p[0]) * std::cos(3 * p[1]) + 7 + sheet * gap +
                                 (sheet == 2 ? std::abs(p[0] - 0.5) : 0)});
  }

 private:
  TriangleMesh surface(int count) const {
    std::vector<VertexTuple<3>> triangles;
    const auto vertices = static_cast<Index>(file.positions.size());
    for (Index sheet = 0; sheet < count; ++sheet)
      for (const auto& [a, b, c] : file.triangles)
        triangles.push_back({a + sheet * vertices, b + sheet * vertices, c + sheet * vertices});
    return {count * vertices, triangles};
  }
};

std::vector<Vec3> plain(const std::vector<Vec3>& positions) {
  std::vector<Vec3> rounded;
  for (const Vec3& p : positions) rounded.push_back(p.cast<float>().cast<double>());
  return rounded;
}

void shake_apart(std::vector<Vec3>& positions, double size) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-size, size);
  for (Vec3& p : positions) p += Vec3(any(random), any(random), any(random));
}

TEST(RoundToFloats, WhatIsApartStaysApart) {
  for (const int count : {2, 3})
    for (const double gap : {1e-6, 1e-7, 1e-9, 1e-12}) {
      Sheets sheets(gap, count);
      shake_apart(sheets.positions, gap / 50);
      SelfCollisionFinder finder(sheets.mesh, sheets.positions);
      ASSERT_TRUE(finder.find_pairs().empty()) << gap;
      const std::vector<Vec3> rounded = round_to_floats(sheets.mesh, finder, sheets.positions, {});
      for (std::size_t v = 0; v < rounded.size(); ++v) {
        EXPECT_EQ(rounded[v], plain({rounded[v]})[0]) << "a float";
        EXPECT_LT((rounded[v] - sheets.positions[v]).norm(), (kRoundingSteps + 1) * 8 * 1.2e-7);
      }
      finder.update(plain(sheets.positions));
      EXPECT_TRUE(gap > 1e-7 || !finder.find_pairs().empty()) << "each by itself they cross";
      finder.update(rounded);
      EXPECT_TRUE(finder.find_pairs().empty()) << count << " sheets, " << gap;
    }
}

TEST(RoundToFloats, MovesNothingElse) {
  Sheets sheets(0.01);
  SelfCollisionFinder finder(sheets.mesh, sheets.positions);
  EXPECT_EQ(round_to_floats(sheets.mesh, finder, sheets.positions, {}), plain(sheets.positions));
  // Those that cross before may go on crossing.
  Sheets crossing(0.01);
  for (std::size_t v = crossing.positions.size() / 2; v < crossing.positions.size(); ++v)
    crossing.positions[v][2] -= 0.05 * crossing.positions[v][0] - 0.17;
  finder = SelfCollisionFinder(crossing.mesh, crossing.positions);
  const std::vector<TrianglePair> pairs = finder.find_pairs();
  ASSERT_FALSE(pairs.empty());
  EXPECT_EQ(round_to_floats(crossing.mesh, finder, crossing.positions, pairs), plain(crossing.positions));
  // What no float can hold is left to itself.
  crossing.positions[0][0] = 1e300;
  finder.update(crossing.positions);
  EXPECT_EQ(round_to_floats(crossing.mesh, finder, crossing.positions, {})[1], plain(crossing.positions)[1]);
}

}  // namespace
}  // namespace selvage
