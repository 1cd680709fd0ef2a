#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that are inside out or flat, ascending.
std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions);

/// Holds back the vertices whose motion turns elements inside out: they go half as far, and half again, and then stay.
///
/// @param before     (n_vertices x 3) where they came from [m]
/// @param inverted   elements that were inverted there: these may stay so
/// @param positions  (n_vertices x 3) where they go; changed [m]
/// @return those of `inverted` that still are, and no others; ascending
std::vector<Index> keep_upright(const TetMesh& mesh, std::span<const Vec3> before, std::span<const Index> inverted,
                                std::span<Vec3> positions);

}  // namespace selvage
