#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that are inside out or flat, ascending.
std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions);

/// Holds back the vertices whose motion turns elements inside out: a number of times they go the mean way of their
/// neighbours instead, then half as far, and half again, and then they stay.
///
/// @param before     (n_vertices x 3) where they came from [m]
/// @param inverted   elements that were inverted there: these may stay so
/// @param evenings   how often a vertex takes the mean way
/// @param positions  (n_vertices x 3) where they go; changed [m]
/// @return those of `inverted` that still are, and no others; ascending
std::vector<Index> keep_upright(const TetMesh& mesh, std::span<const Vec3> before, std::span<const Index> inverted,
                                int evenings, std::span<Vec3> positions);

}  // namespace selvage
