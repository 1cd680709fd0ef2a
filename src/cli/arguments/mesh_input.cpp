#include "cli/arguments/mesh_input.h"

#include <algorithm>

namespace selvage::cli {

bool is_planar(const IndexedMesh& mesh) {
  return mesh.tetrahedra.empty() &&
         std::all_of(mesh.positions.begin(), mesh.positions.end(), [](const Vec3& p) { return p[2] == 0; });
}

std::vector<Vec2> drop_z(std::span<const Vec3> positions) {
  std::vector<Vec2> planar;
  planar.reserve(positions.size());
  for (const Vec3& p : positions) planar.emplace_back(p[0], p[1]);
  return planar;
}

}  // namespace selvage::cli
