#include "simulation/time_step/deformation_damping.h"

namespace selvage {

void damp_deformation(const Pieces& pieces, double kept, std::span<const Vec3> positions, std::span<Vec3> velocities) {
  std::vector<RigidMotion> motions;
  for (const MomentumSums& piece : pieces.momentum(
           positions, [](Index) { return true; }, [&](Index v) { return velocities[v]; }))
    motions.push_back(piece.motion());
  pieces.visit_vertices([&](Index piece, Index v) {
    const Vec3 together = motions[piece](positions[v]);
    velocities[v] = together + kept * (velocities[v] - together);
  });
}

}  // namespace selvage
