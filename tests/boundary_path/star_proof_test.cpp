#include "boundary_path/injectivity/star_proof.h"

#include "mesh/simplex_corners.h"
#include "selvage/geometry/predicates.h"
#include "solids.h"
#include "test_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace selvage {
namespace {

using solids::Solid;
using test::Random;

bool is_proven(const std::vector<Vec3>& x, const std::vector<VertexTuple<4>>& elements, Index vertex = 0) {
  return is_star_proven_apart(TetMesh(static_cast<Index>(x.size()), elements), x, vertex);
}

class StarProofOf : public testing::TestWithParam<solids::Family> {};

// Points near a vertex, inside one of its elements, are in none of its others.
TEST_P(StarProofOf, HoldsInEveryPoseOfEveryMotion) {
  for (const solids::Motion& motion : solids::motions()) {
    Random random(test::seed(7));
    Solid solid = GetParam().make(random);
    const TetMesh mesh = solid.mesh();
    for (int step = 0; step < 3; ++step) {
      motion.move(solid.positions, random);
      const std::vector<Vec3>& x = solid.positions;
      for (Index v = 0; v < mesh.vertex_count(); ++v) {
        if (!is_star_proven_apart(mesh, x, v)) continue;
        for (const Index e : mesh.vertex_elements(v)) {
          const auto corners = corners_of(mesh.elements()[e], x);
          ASSERT_GT(orientation(corners), 0) << motion.name << ' ' << v;
          const Vec3 inner = (corners[0] + corners[1] + corners[2] + corners[3]) / 4, p = x[v] + (inner - x[v]) / 64;
          if (!locate_in_simplex<3>(corners, p).inside) continue;
          for (const Index other : mesh.vertex_elements(v))
            ASSERT_TRUE(other == e || !locate_in_simplex<3>(corners_of(mesh.elements()[other], x), p).inside)
                << motion.name << ' ' << v;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, StarProofOf, testing::ValuesIn(solids::families()),
                         [](const auto& family) { return family.param.name; });

TEST(StarProof, FindsEveryVertexOfAnUnevenBox) {
  Solid box = solids::box({0, 0, 0}, {1, 2, 3}, 0.5);
  Random random(test::seed(8));
  for (Vec3& p : box.positions) p += random.vector(0.02);
  const TetMesh mesh = box.mesh();
  for (Index v = 0; v < mesh.vertex_count(); ++v) EXPECT_TRUE(is_star_proven_apart(mesh, box.positions, v)) << v;
}

// Two that have only the vertex in common and are on both sides of a plane, y = 0, but of no plane through a face.
TEST(StarProof, FindsAPlaneThroughEdges) {
  const std::vector<Vec3> x{{0, 0, 0}, {4, 4, 0}, {-2, 5, 2}, {-4, 3, 0}, {0, -4, 4}, {2, -5, -4}, {2, -3, 0}};
  std::array<VertexTuple<4>, 2> pair{{{0, 1, 2, 3}, {0, 4, 5, 6}}};
  for (auto& element : pair)
    if (orientation(corners_of(element, x)) < 0) std::swap(element[2], element[3]);
  EXPECT_TRUE(is_proven(x, {pair[0], pair[1]}));
}

TEST(StarProof, IsNoneOfWhatOverlapsOrTouches) {
  const std::vector<Vec3> x{{0, 0, 0}, {1, 0, 0},  {0, 1, 0},     {0, 0, 1},  {1, 0, 0},
                            {0, 1, 0}, {0, 0, -1}, {0.2, 0.2, 1}, {1, -1, 1}, {-1, 1, 1}};
  EXPECT_TRUE(is_proven(x, {{0, 1, 2, 3}}));
  EXPECT_TRUE(is_proven(x, {{0, 1, 2, 3}, {0, 2, 1, 6}})) << "a face in common";
  EXPECT_FALSE(is_proven(x, {{0, 1, 2, 3}, {0, 5, 4, 6}})) << "a face at the same place";
  EXPECT_FALSE(is_proven(x, {{0, 1, 2, 3}, {0, 2, 4, 6}})) << "an edge in common, another at the same place";
  EXPECT_FALSE(is_proven(x, {{0, 1, 2, 3}, {0, 1, 2, 7}})) << "the same side of a face";
  EXPECT_FALSE(is_proven(x, {{0, 2, 1, 3}})) << "inside out";
  EXPECT_FALSE(is_proven(x, {{0, 1, 2, 4}})) << "flat";
  std::vector<Vec3> far = x;
  far[3] = {0, 0, std::numeric_limits<double>::max()};
  EXPECT_FALSE(is_proven(far, {{0, 1, 2, 3}})) << "too large for doubles";
}

// A fan around an edge, that turns once or nearly twice.
TEST(StarProof, TellsAFanThatTurnsTooFar) {
  for (const auto& [parts, turn] : {std::pair(5, 0.9), std::pair(9, 1.1), std::pair(12, 1.9)}) {
    std::vector<Vec3> x{{0, 0, 0}, {0, 0, 1}};
    std::vector<VertexTuple<4>> fan;
    for (int i = 0; i <= parts; ++i) {
      const double angle = turn * 6.283185307179586 * i / parts;
      x.emplace_back(std::cos(angle), std::sin(angle), 0);
      if (i > 0) fan.push_back({0, i + 1, i + 2, 1});
    }
    EXPECT_EQ(is_proven(x, fan), turn < 1) << turn;
  }
}

// As many elements as there may be at a vertex.
TEST(StarProof, GivesUpOnVeryManyElements) {
  std::vector<Vec3> x{{0, 0, 0}, {0, 0, 1}};
  std::vector<VertexTuple<4>> fan;
  for (int i = 0; i <= 70; ++i) {
    x.emplace_back(std::cos(0.05 * i), std::sin(0.05 * i), 0);
    if (i > 0) fan.push_back({0, i + 1, i + 2, 1});
    if (i == 60 || i == 70) {
      EXPECT_EQ(is_proven(x, fan), i == 60);
    }
  }
}

}  // namespace
}  // namespace selvage
