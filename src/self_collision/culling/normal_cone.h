#pragma once

#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/planar_embedding.h"

namespace selvage {

/// `CullingMethod::kNormalCone`: culls the nodes that pass the normal cone test (NCT). A piece of surface has no
/// self-collision when all of its normals have a positive product with one direction (surface normal test), and its
/// contour, projected along that direction, meets itself nowhere (contour test). The direction is the axis of the
/// node's surface normal cone (SNC). Decided with bounds of all rounding. Misses no pair.
///
/// Nodes whose children are triangles are not culled: testing them costs as much as comparing.
///
/// @param contour  the contour edges that are compared; all for the published test
/// @param test     memory to use again for every pose
///
/// Source: Volino, Magnenat-Thalmann 1994 (the test); Provot 1997 (normals bounded by cones); Tang and others 2009
/// (over a step). docs/how_it_works/self_collision_cones.md, theorem 1, adds what is needed for several contours.
template <int kSteps>
CulledPairs cull_by_normal_cones(ContourTest contour, const Bvh& bvh, SurfacePieces& pieces,
                                 const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                 PlanarEmbeddingTest<kSteps>& test);

}  // namespace selvage
