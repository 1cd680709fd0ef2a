#include "simulation/find_inverted.h"

#include "selvage/geometry/predicates.h"

namespace selvage {

std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions) {
  std::vector<Index> inverted;
  for (Index e = 0; e < mesh.element_count(); ++e) {
    const auto& [a, b, c, d] = mesh.elements()[e];
    if (orientation(std::array{positions[a], positions[b], positions[c], positions[d]}) <= 0) inverted.push_back(e);
  }
  return inverted;
}

}  // namespace selvage
