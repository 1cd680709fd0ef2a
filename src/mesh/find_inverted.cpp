#include "mesh/find_inverted.h"

#include "core/parallel.h"
#include "selvage/geometry/predicates.h"

namespace selvage {

std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions) {
  std::vector<std::uint8_t> is_inverted(mesh.element_count());
  parallel_for(mesh.element_count(), kGrain, [&](std::int64_t e) {
    const auto& [a, b, c, d] = mesh.elements()[e];
    is_inverted[e] = orientation(std::array{positions[a], positions[b], positions[c], positions[d]}) <= 0;
  });
  std::vector<Index> inverted;
  for (Index e = 0; e < mesh.element_count(); ++e)
    if (is_inverted[e] != 0) inverted.push_back(e);
  return inverted;
}

}  // namespace selvage
