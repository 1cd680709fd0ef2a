#pragma once

#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// Rounds positions to floats so that the triangles of a surface that are apart stay apart. Where bodies press on one
/// another they are apart by less than a float tells, and rounded each by itself some would cross. These are moved
/// apart by a few units of rounding. That undoes what contacts and pressed layers have, but not sheets upon sheets that
/// lie everywhere nearer than floats are to one another: there the best of some tries is given.
///
/// @param finder  of the surface, in any pose; afterwards in another
/// @param pairs   that meet before rounding, as find_pairs() gives them
/// @return        (n_vertices) doubles that are floats, each within kRoundingSteps units of rounding of the largest
///                coordinates around it. The same bits for any number of threads. One search; up to twelve more where
///                something had to be moved
std::vector<Vec3> round_to_floats(const TriangleMesh& surface, SelfCollisionFinder& finder,
                                  std::span<const Vec3> positions, std::span<const TrianglePair> pairs);

inline constexpr int kRoundingSteps = 78;

}  // namespace selvage
