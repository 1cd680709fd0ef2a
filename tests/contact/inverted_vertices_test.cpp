#include "contact/input/inverted_vertices.h"

#include <gtest/gtest.h>

namespace selvage {
namespace {

using Vertices = std::array<Index, 2>;
using Weights = std::array<double, 2>;

/// A positive, an inverted and a flat element; the first two have vertex 3 in common, the last two vertex 6.
const TetMesh& scraps() {
  static const TetMesh mesh(10, {{0, 1, 2, 3}, {3, 4, 5, 6}, {6, 7, 8, 9}});
  return mesh;
}

std::vector<Vec3> scrap_positions() {
  return {{0, 0, 0}, {1, 0, 0},   {0, 1, 0}, {0, 0, 1}, {1, 0, 1},
          {0, 1, 1}, {0, 0, 0.5}, {5, 0, 0}, {5, 1, 0}, {5, 1, 0}};
}

TEST(InvertedVertices, AreThoseOfInvertedElements) {
  const std::vector<Index> suspects{1, 2}, others{0, 2};
  const InvertedVertices all(scraps(), scrap_positions()), some(scraps(), scrap_positions(), suspects);
  for (Index v = 0; v < 10; ++v)
    for (const InvertedVertices* inverted : {&all, &some})
      EXPECT_EQ(inverted->has_any(Vertices{v, 0}, Weights{1, 1}), v >= 3 && v <= 6) << v;
  EXPECT_FALSE(all.empty());
  EXPECT_TRUE(InvertedVertices(scraps(), scrap_positions(), others).empty());
  EXPECT_TRUE(InvertedVertices().empty());
}

TEST(InvertedVertices, CountWhereTheyHaveAWeight) {
  const InvertedVertices inverted(scraps(), scrap_positions());
  EXPECT_TRUE(inverted.has_any(Vertices{0, 4}, Weights{0.5, 0.5}));
  EXPECT_TRUE(inverted.has_any(Vertices{0, 4}, Weights{2, -1}));
  EXPECT_FALSE(inverted.has_any(Vertices{0, 4}, Weights{1, 0}));
}

}  // namespace
}  // namespace selvage
