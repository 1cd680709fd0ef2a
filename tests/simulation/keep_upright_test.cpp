#include "simulation/keep_upright.h"

#include "selvage/mesh/shapes.h"

#include <gtest/gtest.h>

#include <random>

namespace selvage {
namespace {

struct Block {
  MeshFile file = make_box(Vec3::Ones(), 0.25);
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};
  const std::vector<Vec3>& before = file.positions;
};

std::vector<Vec3> shaken(const std::vector<Vec3>& positions, double by, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> shift(-by, by);
  std::vector<Vec3> result = positions;
  for (Vec3& p : result) p += Vec3(shift(engine), shift(engine), shift(engine));
  return result;
}

TEST(KeepUpright, LeavesAloneWhatTurnsNothing) {
  const Block block;
  const std::vector<Vec3> moved = shaken(block.before, 0.01, 1);
  std::vector<Vec3> kept = moved;
  EXPECT_TRUE(keep_upright(block.mesh, block.before, {}, 0, kept).empty());
  EXPECT_EQ(kept, moved);
}

TEST(KeepUpright, NoElementTurnsHoweverVerticesMove) {
  const Block block;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const std::vector<Vec3> moved = shaken(block.before, 0.05 * (1 + seed), seed);
    std::vector<Vec3> kept = moved;
    keep_upright(block.mesh, block.before, {}, 0, kept);
    EXPECT_TRUE(find_inverted(block.mesh, kept).empty()) << seed;
    for (std::size_t v = 0; v < kept.size(); ++v) {
      const double share = (kept[v] - block.before[v]).norm() / (moved[v] - block.before[v]).norm();
      EXPECT_TRUE(share == 0 || std::abs(std::log2(share) - std::round(std::log2(share))) < 1e-9) << share;
    }
  }
}

/// What is pushed takes its surroundings along, and so gets farther than where it goes alone.
TEST(KeepUpright, EvenedWaysTurnNothingAndGoFarther) {
  const Block block;
  std::vector<Vec3> pushed = block.before;
  for (Vec3& p : pushed)
    if (p.isApprox(Vec3(0.5, 0.5, 0))) p[2] += 0.4;
  const auto length_of_ways = [&](int evenings) {
    std::vector<Vec3> kept = pushed;
    EXPECT_TRUE(keep_upright(block.mesh, block.before, {}, evenings, kept).empty());
    EXPECT_TRUE(find_inverted(block.mesh, kept).empty());
    double sum = 0;
    for (std::size_t v = 0; v < kept.size(); ++v) sum += (kept[v] - block.before[v]).norm();
    return sum;
  };
  const double alone = length_of_ways(0);
  EXPECT_GT(alone, 0);
  EXPECT_GT(length_of_ways(8), alone);
}

TEST(KeepUpright, OnlyVerticesOfWhatTurnsAreHeldBack) {
  const Block block;
  // One vertex is pushed through the block; all others go a little.
  std::vector<Vec3> moved = shaken(block.before, 0.001, 2);
  moved[0] = Vec3(3, 3, 3);
  std::vector<Vec3> kept = moved;
  keep_upright(block.mesh, block.before, {}, 0, kept);
  for (Index v = 0; v < block.mesh.vertex_count(); ++v) {
    bool is_near = false;
    for (const Index e : block.mesh.vertex_elements(0))
      for (const Index w : block.mesh.elements()[e]) is_near |= v == w;
    if (!is_near) {
      EXPECT_EQ(kept[v], moved[v]) << v;
    }
  }
  EXPECT_NE(kept[0], moved[0]);
}

TEST(KeepUpright, WhatWasInvertedMayStaySoOrTurnBack) {
  Block block;
  const std::vector<Vec3> upright = block.before;
  std::vector<Vec3> turned = upright;
  turned[0] = Vec3(0.6, 0.6, 0.6);
  const std::vector<Index> inverted = find_inverted(block.mesh, turned);
  ASSERT_FALSE(inverted.empty());
  std::vector<Vec3> still = turned;
  EXPECT_EQ(keep_upright(block.mesh, turned, inverted, 0, still), inverted);
  EXPECT_EQ(still, turned);
  std::vector<Vec3> back = upright;
  EXPECT_TRUE(keep_upright(block.mesh, turned, inverted, 0, back).empty());
  EXPECT_EQ(back, upright);
}

}  // namespace
}  // namespace selvage
