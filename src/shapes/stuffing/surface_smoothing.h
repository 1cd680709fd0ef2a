#pragma once

#include "selvage/mesh/indexed_mesh.h"
#include "shapes/stuffing/bcc_lattice.h"

namespace selvage {

/// Spreads the vertices of a stuffed solid evenly over its surface: each goes towards the middle of those around it,
/// and back onto the surface. Where arms are about as thin as cells, this takes away the notches that cuts of the
/// lattice leave.
///
/// A vertex moves only where no dihedral angle of its elements becomes worse than kMinAngle or kMaxAngle, or than
/// the worst of them was: the bounds of stuffing hold. O(vertices), parallel, the same bits for any number of threads.
///
/// @param first_vertices  (n_blocks + 1) of each block of the lattice: its vertices are numbered one after the other
void smooth_surface(const ImplicitSolid& solid, const BccLattice& lattice, std::span<const std::int64_t> first_vertices,
                    IndexedMesh& mesh);

}  // namespace selvage
