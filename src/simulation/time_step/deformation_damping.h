#pragma once

#include "simulation/time_step/pieces.h"

namespace selvage {

/// Damps all but the rigid motion of each piece. A piece keeps its momentum and its angular momentum, and falls and
/// turns as without. Pinned vertices do not count. The same bits for any number of threads. O(n).
///
/// @param momentum    (n_pieces) of these velocities
/// @param kept        of the velocities relative to the rigid motion, 0 to 1
/// @param positions   (n_vertices) [m]
/// @param velocities  (n_vertices) [m/s]; updated
void damp_deformation(const Pieces& pieces, std::span<const MomentumSums> momentum, double kept,
                      std::span<const Vec3> positions, std::span<Vec3> velocities);

}  // namespace selvage
