#include "contact/input/inverted_vertices.h"

#include "core/parallel.h"
#include "mesh/simplex_corners.h"
#include "selvage/geometry/predicates.h"

#include <algorithm>
#include <numeric>

namespace selvage {

namespace {

std::vector<Index> all_elements(const TetMesh& mesh) {
  std::vector<Index> elements(mesh.element_count());
  std::iota(elements.begin(), elements.end(), 0);
  return elements;
}

}  // namespace

InvertedVertices::InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions)
    : InvertedVertices(mesh, positions, all_elements(mesh)) {}

InvertedVertices::InvertedVertices(const TetMesh& mesh, std::span<const Vec3> positions,
                                   std::span<const Index> elements) {
  std::vector<std::uint8_t> is_inverted(elements.size());
  parallel_for(std::ssize(elements), kGrain, [&](std::int64_t i) {
    is_inverted[i] = orientation(corners_of(mesh.elements()[elements[i]], positions)) < 0;
  });
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto& corners = mesh.elements()[elements[i]];
    if (is_inverted[i] != 0) vertices_.insert(vertices_.end(), corners.begin(), corners.end());
  }
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
}

bool InvertedVertices::has(Index vertex) const {
  return std::binary_search(vertices_.begin(), vertices_.end(), vertex);
}

}  // namespace selvage
