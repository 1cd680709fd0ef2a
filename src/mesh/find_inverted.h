#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that are inside out or flat, ascending.
std::vector<Index> find_inverted(const TetMesh& mesh, std::span<const Vec3> positions);

}  // namespace selvage
