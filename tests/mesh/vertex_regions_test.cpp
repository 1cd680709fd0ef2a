#include "mesh/vertex_regions.h"

#include "selvage/shapes/shapes.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

namespace selvage {
namespace {

TEST(VertexRegions, AreThePiecesOfAMesh) {
  const IndexedMesh box = make_box(Vec3::Ones(), 0.5), file = concatenate(std::vector{box, box});
  const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  std::vector<Index> vertices(file.positions.size());
  std::iota(vertices.begin(), vertices.end(), 0);
  VertexRegions regions(mesh, vertices);
  const auto half = static_cast<Index>(box.positions.size());
  for (const Index v : vertices) EXPECT_EQ(regions.find(v), v < half ? 0 : half);
}

// A path of elements from one to the other shows that two are of one region: found anew by spreading, ring by ring.
TEST(VertexRegions, AreConnectedByTheirOwnVerticesAlone) {
  const IndexedMesh file = make_box(Vec3(4, 1, 1), 0.25);
  const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  std::vector<Index> vertices;  // without a slab in the middle, in an order of its own
  for (Index v = mesh.vertex_count() - 1; v >= 0; --v)
    if (std::abs(file.positions[v][0] - 2) > 0.2) vertices.push_back(v);
  std::vector<Index> region(mesh.vertex_count(), kNone);
  for (const Index v : vertices) region[v] = v;
  for (bool changed = true; std::exchange(changed, false);)
    for (const auto& element : mesh.elements())
      for (const Index a : element)
        for (const Index b : element)
          if (region[a] != kNone && region[b] != kNone && region[a] < region[b]) {
            region[b] = region[a];
            changed = true;
          }
  VertexRegions regions(mesh, vertices);
  std::map<Index, int> sizes;
  for (const Index v : vertices) {
    EXPECT_EQ(regions.find(v), region[v]);
    ++sizes[regions.find(v)];
  }
  EXPECT_EQ(sizes.size(), 2U);
}

}  // namespace
}  // namespace selvage
