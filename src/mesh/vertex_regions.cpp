#include "mesh/vertex_regions.h"

#include <algorithm>

namespace selvage {

VertexRegions::VertexRegions(const TetMesh& mesh, std::span<const Index> vertices)
    : parents_(mesh.vertex_count(), kNone) {
  for (const Index v : vertices) parents_[v] = v;
  for (const auto& element : mesh.elements())
    for (int a = 1; a < 4; ++a)
      for (int b = 0; b < a; ++b) join(element[a], element[b]);
}

void VertexRegions::join(Index a, Index b) {
  if (parents_[a] < 0 || parents_[b] < 0) return;
  const auto [low, high] = std::minmax({find(a), find(b)});
  parents_[high] = low;
}

}  // namespace selvage
