#pragma once

#include "selvage/io/mesh_file.h"

namespace selvage::cli {

/// Whether a mesh is one of triangles in the plane: it has no tetrahedron, and all z are exactly 0.
bool is_planar(const IndexedMesh& mesh);

/// The first two coordinates of each point.
std::vector<Vec2> drop_z(std::span<const Vec3> positions);

}  // namespace selvage::cli
