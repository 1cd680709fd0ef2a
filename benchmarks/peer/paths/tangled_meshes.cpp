#include "peer/paths/tangled_meshes.h"

#include "selvage/shapes/poses.h"
#include "selvage/shapes/shapes.h"

#include <algorithm>
#include <cmath>

namespace selvage::bench {

namespace {

/// Shears a mesh along x, so that what later lies upon itself is out of step by a share of the length.
void lean(IndexedMesh& mesh, double share) {
  for (Vec3& x : mesh.positions) x[2] += share * x[0];
}

IndexedMesh make_two_squishy_balls(double cell) {
  const IndexedMesh ball = make_squishy_ball(1, 40, cell, 1);
  return concatenate(std::vector{ball, ball});
}

}  // namespace

std::span<const TangledShape> tangled_shapes() {
  static const std::array<TangledShape, 5> kShapes = {{
      {"octopus", [](double cell) { return make_octopus(1, cell, 1); },
       [](IndexedMesh& mesh) { pose_swirl(mesh, 0.5, 0.15); }, 0.066},
      {"squishy-balls", make_two_squishy_balls,
       [](IndexedMesh& mesh) {
         const Index half = static_cast<Index>(mesh.positions.size() / 2);
         pose_overlap(mesh.positions, half, Vec3(1.6137, 0.2319, 0.1713));
       },
       0.1},
      {"rod", [](double cell) { return make_rod(RodCurve::kStraight, 4, 0.1, cell); },
       [](IndexedMesh& mesh) {
         lean(mesh, 0.0137);
         pose_self_crossing(mesh.positions, 0, 2);
       },
       0.05},
      {"beam",
       [](double cell) {
         return make_box({4, 0.3, 0.3}, cell);
       },
       [](IndexedMesh& mesh) {
         pose_twist(mesh.positions, 0, 0.5);
         lean(mesh, 0.0237);
         pose_bend(mesh.positions, 0, 1.2371);
       },
       0.05},
      // Nearly every vertex that penetrates lies exactly in the plane of some face.
      {"aligned-rod", [](double cell) { return make_rod(RodCurve::kStraight, 4, 0.1, cell); },
       [](IndexedMesh& mesh) { pose_self_crossing(mesh.positions, 0, 2); }, 0.05},
  }};
  return kShapes;
}

IndexedMesh make_tangled(const TangledShape& shape, std::int64_t elements) {
  double cell = shape.coarsest_cell;
  IndexedMesh best = shape.make(cell);
  const auto error = [&](const IndexedMesh& mesh) {
    return std::abs(std::log(static_cast<double>(mesh.tetrahedra.size()) / static_cast<double>(elements)));
  };
  // The count goes with the cube of the cell, about; layers come and go as a whole.
  IndexedMesh mesh = best;
  for (int i = 0; i < 6 && error(best) > 0.1; ++i) {
    const double ratio = static_cast<double>(mesh.tetrahedra.size()) / static_cast<double>(elements);
    cell = std::min(cell * std::cbrt(ratio), shape.coarsest_cell);
    mesh = shape.make(cell);
    if (error(mesh) < error(best)) best = mesh;
  }
  shape.tangle(best);
  return best;
}

}  // namespace selvage::bench
