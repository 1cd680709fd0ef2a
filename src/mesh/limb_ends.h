#pragma once

#include "selvage/mesh/simplex_mesh.h"

#include <map>

namespace selvage {

/// The part that a region cuts off a mesh.
struct LimbEnd {
  std::int64_t vertices = 0;
  /// Unit normal of the cut, from the end into the region. A region that moves this way draws the end after it.
  Vec3 way = Vec3::Zero();
};

/// Limb ends. A region whose removal leaves two or more connected pieces has the second largest as its end. The largest
/// stays where it is; smaller ones may be a few vertices in between those of the region. So may the second largest: it
/// is left out where it has less than half as many vertices as the region.
///
/// @param positions  (n_vertices x 3) [m]
/// @param regions    (n_vertices) region of each vertex, kNone where it is of none
/// @return by region; regions without an end are left out
///
/// O(elements), and for each region as much as there are regions and pieces between them.
std::map<Index, LimbEnd> find_limb_ends(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Index> regions);

}  // namespace selvage
