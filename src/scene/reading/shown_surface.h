#pragma once

#include "selvage/core/types.h"
#include "selvage/io/mesh_file.h"

#include <vector>

namespace selvage {

/// The triangles of a mesh that are drawn, in the order in which `check` numbers them.
std::vector<VertexTuple<3>> surface_triangles(const IndexedMesh& mesh);

/// The vertices that some triangles use, ascending, and the triangles in their numbers.
struct ShownSurface {
  std::vector<Index> vertices;  ///< (n_shown) numbers in the mesh
  std::vector<Index> place;     ///< (n_vertices) number among those shown; kNone: not shown
  std::vector<VertexTuple<3>> triangles;

  ShownSurface(std::size_t vertex_count, std::span<const VertexTuple<3>> surface);
};

}  // namespace selvage
