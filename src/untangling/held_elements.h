#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that pins hold in a tangle, however all else may move: with all their vertices pinned and inverted, or
/// inside of others such; or with a face that is pinned and meets another. Ascending. Where there are none, it may be
/// impossible all the same to resolve the mesh.
///
/// @param positions  (n_vertices x 3) [m]
/// @param pinned     vertices, in any order
std::vector<Index> find_held_elements(const TetMesh& mesh, std::span<const Vec3> positions,
                                      std::span<const Index> pinned);

}  // namespace selvage
