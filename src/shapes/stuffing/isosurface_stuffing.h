#pragma once

#include "selvage/mesh/indexed_mesh.h"
#include "shapes/stuffing/implicit_solid.h"

namespace selvage {

/// Tetrahedra that fill a solid, all dihedral angles between 10.7 and 164.8 degrees whatever its form: a body-centred
/// cubic lattice whose vertices near the surface move onto it, and whose tetrahedra are cut along it.
///
/// Features thinner than about a cell may be lost. O(cubes near the solid), parallel, the same bits for any number of
/// threads. About 30 bytes a tetrahedron while building, beside the mesh.
///
/// @param cell    edge length of the lattice's cubes; edges are of length 1 and 0.87 cell before the surface moves them
/// @throws Error  when the mesh would have more than 2^29 elements, or none
/// Source: Labelle and Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles, 2007.
IndexedMesh stuff_isosurface(const ImplicitSolid& solid, double cell);

}  // namespace selvage
