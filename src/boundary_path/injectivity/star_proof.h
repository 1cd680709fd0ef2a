#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Whether the elements around a vertex are proven to be positive and to have nothing in common but the vertices,
/// edges and faces that they share: some plane through a face of one of any two has the other beyond it. Computed in
/// doubles with a bound of all rounding; where that leaves a doubt, nothing is proven.
bool is_star_proven_apart(const TetMesh& mesh, std::span<const Vec3> positions, Index vertex);

}  // namespace selvage
