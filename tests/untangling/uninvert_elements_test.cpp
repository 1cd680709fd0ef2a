#include "untangling/solids/uninvert_elements.h"

#include "mesh/find_inverted.h"
#include "selvage/shapes/shapes.h"
#include "threads.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace selvage {
namespace {

struct Block {
  IndexedMesh file = make_box(Vec3::Ones(), 0.25);
  TetMesh mesh{static_cast<Index>(file.positions.size()), file.tetrahedra};
  const std::vector<Vec3>& rest = file.positions;
  const std::vector<std::uint8_t> all = std::vector<std::uint8_t>(file.positions.size(), 1);
  const Freedom anywhere{all, file.positions, std::numeric_limits<double>::infinity()};
};

std::vector<Vec3> shaken(const std::vector<Vec3>& positions, double by, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> shift(-by, by);
  std::vector<Vec3> result = positions;
  for (Vec3& p : result) p += Vec3(shift(engine), shift(engine), shift(engine));
  return result;
}

/// One corner is pushed far into the block.
struct PiercedBlock : Block {
  std::vector<Vec3> pierced = rest;
  PiercedBlock() { pierced[0] = Vec3(0.6, 0.6, 0.6); }
};

TEST(UninvertElements, KeepsPositiveElements) {
  const Block block;
  std::vector<Vec3> positions = shaken(block.rest, 0.01, 1);
  const std::vector<Vec3> before = positions;
  EXPECT_TRUE(uninvert_elements(block.mesh, block.rest, {}, block.anywhere, positions).empty());
  EXPECT_EQ(positions, before);
}

TEST(UninvertElements, RestoresAVertexPushedThroughTheBlockAndMovesNothingFarAway) {
  const PiercedBlock block;
  std::vector<Vec3> positions = block.pierced;
  const std::vector<Vec3>& before = block.pierced;
  const std::vector<Index> inverted = find_inverted(block.mesh, positions);
  ASSERT_FALSE(inverted.empty());
  EXPECT_TRUE(uninvert_elements(block.mesh, block.rest, inverted, block.anywhere, positions).empty());
  EXPECT_TRUE(find_inverted(block.mesh, positions).empty());
  EXPECT_NE(positions[0], before[0]);
  for (std::size_t v = 0; v < positions.size(); ++v)
    if ((block.rest[v] - block.rest[0]).norm() > 1) {
      EXPECT_EQ(positions[v], before[v]) << v;
    }
}

TEST(UninvertElements, RestoresManyAtOnce) {
  const Block block;
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::vector<Vec3> positions = shaken(block.rest, 0.15, seed);
    const std::vector<Index> inverted = find_inverted(block.mesh, positions);
    ASSERT_GT(inverted.size(), 20u);
    EXPECT_TRUE(uninvert_elements(block.mesh, block.rest, inverted, block.anywhere, positions).empty()) << seed;
  }
}

// Separate regions are restored in parallel.
TEST(UninvertElements, GivesTheSameBitsForAnyNumberOfThreads) {
  const IndexedMesh file = make_box(Vec3(4, 1, 1), 0.2);
  const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  const std::vector<std::uint8_t> all(file.positions.size(), 1);
  const Freedom anywhere{all, file.positions, std::numeric_limits<double>::infinity()};
  std::vector<Vec3> pierced = file.positions;
  for (std::size_t v = 0; v < pierced.size(); ++v)
    if (std::fmod(pierced[v][0], 1.0) < 0.1 && pierced[v][1] == 0 && pierced[v][2] == 0)
      pierced[v] += Vec3(0, 0.45 - 0.01 * pierced[v][0], 0.5);
  const std::vector<Index> inverted = find_inverted(mesh, pierced);
  ASSERT_GT(inverted.size(), 20u);
  test::same_for_any_threads([&] {
    std::vector<Vec3> positions = pierced;
    EXPECT_TRUE(uninvert_elements(mesh, file.positions, inverted, anywhere, positions).empty());
    return positions;
  });
}

// Elements that are almost flat at rest take a thickness with which the others stay positive.
TEST(UninvertElements, RestoresElementsThatAreAlmostFlatAtRest) {
  Block block;
  std::vector<Vec3> rest = block.rest;
  for (Vec3& p : rest) p[2] *= 1e-7;
  std::vector<Vec3> positions = rest;
  for (std::size_t v = 0; v < positions.size(); v += 7) positions[v][2] += 1e-3;
  const std::vector<Index> inverted = find_inverted(block.mesh, positions);
  ASSERT_FALSE(inverted.empty());
  EXPECT_TRUE(uninvert_elements(block.mesh, rest, inverted, block.anywhere, positions).empty());
}

TEST(UninvertElements, MovesOnlyFreeVertices) {
  const PiercedBlock block;
  std::vector<Vec3> positions = block.pierced;
  const std::vector<Vec3>& before = block.pierced;
  const std::vector<Index> inverted = find_inverted(block.mesh, positions);
  std::vector<std::uint8_t> is_free(positions.size(), 0);
  const Freedom near{is_free, before, 0.1};
  EXPECT_EQ(uninvert_elements(block.mesh, block.rest, inverted, near, positions), inverted);
  EXPECT_EQ(positions, before);
  is_free[0] = 1;
  EXPECT_FALSE(uninvert_elements(block.mesh, block.rest, inverted, near, positions).empty());
  EXPECT_LE((positions[0] - before[0]).norm(), 0.1);
  for (std::size_t v = 1; v < positions.size(); ++v) ASSERT_EQ(positions[v], before[v]) << v;
}

}  // namespace
}  // namespace selvage
