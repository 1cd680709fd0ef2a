#pragma once

#include "selvage/mesh/simplex_mesh.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage::cli {

/// Number of connected components of a mesh, across faces.
template <int D>
std::int64_t count_components(const SimplexMesh<D>& mesh);

/// Number of connected pieces of a mesh's boundary, across ridges.
template <int D>
std::int64_t count_boundary_components(const SimplexMesh<D>& mesh);

/// Number of connected components of a surface, across edges.
std::int64_t count_components(const TriangleMesh& mesh);

extern template std::int64_t count_components<2>(const PlanarMesh&);
extern template std::int64_t count_components<3>(const TetMesh&);
extern template std::int64_t count_boundary_components<2>(const PlanarMesh&);
extern template std::int64_t count_boundary_components<3>(const TetMesh&);

}  // namespace selvage::cli
