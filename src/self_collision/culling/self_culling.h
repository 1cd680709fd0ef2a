#pragma once

#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/planar_embedding.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// Finds the comparisons of a surface with itself that a method leaves out (docs/how_it_works/self_collision_cones.md);
/// none for kBvh. One file a method: normal_cone.h, dual_cone.h, enhanced_dual_cone.h, planar_embedding.h (`auto`). In
/// one pose or over a step; O(n), parallel; the same for any number of threads.
///
/// @param test     memory to use again for every pose
/// @param rounded  positions of the step in box units, see PlanarEmbeddingTest; for kAuto
/// @param knows_neighbours  whether most triangles are known not to meet their neighbours without culling; for kAuto
template <int kSteps>
CulledPairs cull_self_pairs(const SelfCollisionOptions& options, const Bvh& bvh, SurfacePieces& pieces,
                            const typename PlanarEmbeddingTest<kSteps>::Poses& poses, PlanarEmbeddingTest<kSteps>& test,
                            std::span<const MovingVertex> rounded = {}, bool knows_neighbours = false);

}  // namespace selvage
