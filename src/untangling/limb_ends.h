#pragma once

#include "selvage/mesh/simplex_mesh.h"

#include <map>

namespace selvage {

/// What a region cuts off a mesh.
struct LimbEnd {
  std::int64_t vertices = 0;
  Vec3 way =
      Vec3::Zero();  ///< unit normal of the cut, from there into the region: going so, this draws the end after it
};

/// For each region that cuts what hangs together into two or more, the second largest of these; the largest stays where
/// it is, and smaller ones may be but crumbs between the vertices of the region. So may this one: it is left out where
/// it has less than half as many vertices as the region.
///
/// @param positions  (n_vertices x 3) [m]
/// @param regions    (n_vertices) region of each vertex, kNone where it is of none
/// @return by region; those that cut nothing are left out
///
/// O(elements), and for each region as much as there are regions and pieces between them.
std::map<Index, LimbEnd> find_limb_ends(const TetMesh& mesh, std::span<const Vec3> positions,
                                        std::span<const Index> regions);

}  // namespace selvage
