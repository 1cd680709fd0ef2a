#include "peer/tangled_meshes.h"

#include "selvage/mesh/poses.h"
#include "selvage/mesh/shapes.h"

#include <algorithm>
#include <cmath>

namespace selvage::bench {

std::span<const TangledShape> tangled_shapes() {
  static const std::array<TangledShape, 4> kShapes = {{
      {"octopus", [](double cell) { return make_octopus(1, cell, 1); },
       [](MeshFile& mesh) { pose_swirl(mesh, 0.5, 0.15); }, 0.066},
      {"squishy-ball", [](double cell) { return make_squishy_ball(1, 60, cell, 1); },
       [](MeshFile& mesh) { pose_swirl(mesh, 0.5, 0.15); }, 0.082},
      {"rod", [](double cell) { return make_rod(RodCurve::kStraight, 4, 0.1, cell); },
       [](MeshFile& mesh) { pose_self_crossing(mesh.positions, 0, 2); }, 0.05},
      {"beam",
       [](double cell) {
         return make_box({4, 0.3, 0.3}, cell);
       },
       [](MeshFile& mesh) {
         pose_twist(mesh.positions, 0, 0.5);
         pose_bend(mesh.positions, 0, 1.25);
       },
       0.05},
  }};
  return kShapes;
}

MeshFile make_tangled(const TangledShape& shape, std::int64_t elements) {
  double cell = shape.coarsest_cell;
  MeshFile mesh = shape.make(cell);
  // The count goes with the cube of the cell; the second step mends what the boundary adds.
  for (int i = 0; i < 2; ++i) {
    const double ratio = static_cast<double>(mesh.tetrahedra.size()) / static_cast<double>(elements);
    cell = std::min(cell * std::cbrt(ratio), shape.coarsest_cell);
    mesh = shape.make(cell);
  }
  shape.tangle(mesh);
  return mesh;
}

}  // namespace selvage::bench
