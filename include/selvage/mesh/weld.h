#pragma once

#include "selvage/mesh/indexed_mesh.h"

namespace selvage {

/// Of each vertex the first vertex with the same coordinates, itself where there is none before it. -0 and 0 are the
/// same. O(n log n).
/// @param end_positions  empty, or positions at the end of a step, which must be the same, too
/// @throws Error         when sizes differ
std::vector<Index> find_first_in_place(std::span<const Vec3> positions, std::span<const Vec3> end_positions = {});

/// Lets the triangles of a surface share vertices: each corner becomes the one that `first` names. For formats without
/// shared vertices (STL), and for seams. Vertices keep their numbers; those that are no longer used stay.
///
/// Triangles that have two corners in one place are removed, and their labels (faces, groups) with them.
/// @param first   (n_vertices) as find_first_in_place() gives it, or with fewer vertices joined
/// @return the number that each triangle had before; empty where none was removed
/// @throws Error  when sizes differ, or the mesh has tetrahedra
std::vector<Index> weld_triangles(IndexedMesh& mesh, std::span<const Index> first);

}  // namespace selvage
