#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that pinned vertices keep in collision, wherever all others move. Either all vertices of the element are
/// pinned, and it is inverted or inside another such element; or a face of it is pinned and meets another such face.
/// Ascending. Where there are none, the mesh may still be impossible to resolve.
///
/// @param positions  (n_vertices x 3) [m]
/// @param pinned     vertices, in any order
std::vector<Index> find_held_elements(const TetMesh& mesh, std::span<const Vec3> positions,
                                      std::span<const Index> pinned);

}  // namespace selvage
