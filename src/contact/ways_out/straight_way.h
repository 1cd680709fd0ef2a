#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// The straight way from a point in an element to where it leaves the mesh, from element to element by the face that it
/// leaves first. Its normal is the direction. Not found where it ends nowhere, as among inverted elements. O(elements
/// on the way), a thousand at most.
/// @param positions  (n_vertices) or more [m]
/// @param direction  unit
BoundaryPath<3> straight_way(const TetMesh& mesh, std::span<const Vec3> positions, const Vec3& point, Index element,
                             const Vec3& direction);

/// Unit vectors towards the faces, edges and corners of a cube, and both ways along the axes of a spread of points or
/// ways: its eigenvectors.
std::vector<Vec3> directions_to_try(const Eigen::Matrix3d& spread);

}  // namespace selvage
