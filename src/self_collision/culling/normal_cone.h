#pragma once

#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/planar_embedding.h"
#include "self_collision/culling/surface_cones.h"

namespace selvage {

/// The normal cone test (NCT): a piece of surface has no self-collision when all of its normals have a positive
/// product with one direction (surface normal test), and its contour, projected along that direction, meets itself
/// nowhere (contour test). The direction is the axis of the node's surface normal cone (SNC). Decided with bounds of
/// all rounding: true is certain. False for nodes whose children are triangles: testing them costs as much as
/// comparing.
///
/// @param cones    tell where the test can pass; they decide nothing, because their rounding is not bounded
/// @param contour  which contour edges are compared
///
/// Source: Volino, Magnenat-Thalmann 1994 (the test); Provot 1997 (normals bounded by cones); Tang and others 2009
/// (over a step). docs/how_it_works/self_collision_cones.md, theorem 1, adds what is needed for several contours.
template <int kSteps>
bool passes_normal_cone_test(const Bvh& bvh, const SurfaceCones<kSteps>& cones, const PlanarEmbeddingTest<kSteps>& test,
                             Index node, ContourTest contour,
                             typename PlanarEmbeddingTest<kSteps>::Workspace& workspace);

/// `CullingMethod::kNormalCone`: culls the nodes that pass the normal cone test, every contour edge compared with all
/// others near it. Misses no pair.
///
/// @param test  memory to use again for every pose
template <int kSteps>
CulledPairs cull_by_normal_cones(const Bvh& bvh, SurfacePieces& pieces,
                                 const typename PlanarEmbeddingTest<kSteps>::Poses& poses,
                                 PlanarEmbeddingTest<kSteps>& test);

}  // namespace selvage
