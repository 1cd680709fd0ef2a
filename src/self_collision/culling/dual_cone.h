#pragma once

#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/surface_cones.h"

namespace selvage {

/// The dual-cone test (EDC algorithm 2, DualConeTest): the surface normal cone (SNC) is less than a half space, and the
/// binormal cone (BNC), seen along the axis of the SNC, lies within a half plane. In plain floating point.
///
/// @param normals    SNC of a piece of surface
/// @param binormals  BNC of its contour edges; empty: the second condition holds
///
/// Source: Heo and others 2010 (FASTCD), Dual-Cone Theorem; EDC section 4.2.
bool passes_dual_cone_test(const DirectionCone& normals, const DirectionCone& binormals);

/// The contour edges whose binormals a node's BNC bounds.
enum class ContourEdges : std::uint8_t {
  kBorder,             ///< those on the border of the whole surface
  kBorderAndInternal,  ///< also those between two nodes, in a second BNC
};

/// `CullingMethod::kDualCone` and `kDualConeInternal`: FASTCD as published, without and with internal edges. Both miss
/// pairs (docs/how_it_works/self_collision_cones.md; EDC section 4.3).
template <int kSteps>
CulledPairs cull_by_dual_cones(ContourEdges edges, const Bvh& bvh, SurfacePieces& pieces,
                               const typename SurfaceCones<kSteps>::Poses& poses);

}  // namespace selvage
