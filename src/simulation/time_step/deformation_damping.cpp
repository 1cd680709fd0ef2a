#include "simulation/time_step/deformation_damping.h"

namespace selvage {

void damp_deformation(const Pieces& pieces, std::span<const MomentumSums> momentum, double kept,
                      std::span<const Vec3> positions, std::span<Vec3> velocities) {
  std::vector<RigidMotion> motions;
  for (const MomentumSums& piece : momentum) motions.push_back(piece.motion());
  pieces.visit_vertices([&](Index piece, Index v) {
    const Vec3 together = motions[piece](positions[v]);
    velocities[v] = together + kept * (velocities[v] - together);
  });
}

}  // namespace selvage
