#pragma once

#include "selvage/core/types.h"

#include <string>

namespace selvage {

/// Vertices and the elements that use them, as a file holds them or a shape makes them: vertices in the order of the
/// file, never merged or dropped; tetrahedra, triangles, or both (some formats list a tetrahedral mesh's surface too).
struct IndexedMesh {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<VertexTuple<4>> tetrahedra;
  std::vector<VertexTuple<3>> triangles;

  /// (n_triangles) the file's face, from 0, that each triangle is a part of; empty where every face is a triangle.
  std::vector<Index> faces{};

  /// (n_triangles) the number in `group_names` of each triangle's group, kNone: in none; empty where there is no group.
  /// OBJ has them: objects (`o`) and groups (`g`) are read, objects are written.
  std::vector<Index> groups{};
  std::vector<std::string> group_names{};
};

}  // namespace selvage
