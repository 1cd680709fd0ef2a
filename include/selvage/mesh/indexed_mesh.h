#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Vertices and the elements that use them, as a file holds them or a shape makes them: vertices in the order of the
/// file, never merged or dropped; tetrahedra, triangles, or both (some formats list a tetrahedral mesh's surface too).
struct IndexedMesh {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<VertexTuple<4>> tetrahedra;
  std::vector<VertexTuple<3>> triangles;
};

}  // namespace selvage
