#pragma once

#include "contact/contact_parts.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Numbers the tangles of points inside elements: a point in an element of its own piece of the mesh is in one tangle
/// with all such that share a vertex with it, directly or through others; every other point is in one of its own.
///
/// @param pieces  (n_elements) connected component; or empty: all points are in tangles of their own
/// @return how many there are
Index number_tangles(const TetMesh& mesh, std::span<const Index> pieces, std::span<PenetratingPoint> points);

}  // namespace selvage
