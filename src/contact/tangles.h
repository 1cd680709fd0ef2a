#pragma once

#include "contact/ways_out/path_contact.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Numbers the tangles of points inside elements. Points in elements of their own connected piece of the mesh are in
/// one tangle where they share a vertex, directly or through others. Every other point is a tangle of its own.
///
/// @param pieces  (n_elements) connected component; or empty: all points are in tangles of their own
/// @return how many there are
Index number_tangles(const TetMesh& mesh, std::span<const Index> pieces, std::span<PenetratingPoint> points);

}  // namespace selvage
