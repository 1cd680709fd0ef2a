#pragma once

#include "self_collision/culling/culled_pairs.h"
#include "self_collision/culling/planar_embedding.h"
#include "self_collision/culling/surface_cones.h"

namespace selvage {

/// EDC's set R: the results of a node's tests. The sub-surfaces are the node's children, up to eight in this hierarchy,
/// where EDC takes the four grandchildren of a binary one: 8 tests of condition 2 and 28 of condition 3, not 4 and 6.
struct EnhancedDualConeResult {
  bool passes_normal_test = false;                    ///< condition 1; else nothing else is known
  std::uint8_t passes_alone = 0;                      ///< bit i: sub-surface i passes condition 2
  std::array<std::uint8_t, BvhNode::kWidth> apart{};  ///< bit k of entry i: condition 3 holds for sub-surfaces i and k

  bool all_pass(int child_count) const;
};

/// EDC's conditions 1 to 3 as published (algorithm 4, EnhancedDualConeTest(S, R); algorithm 1 is the same, stopped at
/// the first test that fails). In plain floating point. All together they do not suffice: see
/// docs/how_it_works/self_collision_cones.md, "What the published conditions miss".
template <int kSteps>
EnhancedDualConeResult test_enhanced_dual_cone(const Bvh& bvh, SurfacePieces& pieces, const SurfaceCones<kSteps>& cones,
                                               const std::array<std::span<const Vec3>, kSteps>& poses, Index node);

/// `CullingMethod::kEnhancedDualConePublished`: EDC as published (algorithm 3, SelfCollide). A child that passes
/// condition 2, or a pair of children that passes condition 3, is culled even where the node's other tests fail. Misses
/// pairs.
///
/// @param simple_traversal  cull only nodes that pass all tests, as in EDC's Fig. 13
template <int kSteps>
CulledPairs cull_by_enhanced_dual_cones_as_published(bool simple_traversal, const Bvh& bvh, SurfacePieces& pieces,
                                                     const typename SurfaceCones<kSteps>::Poses& poses);

/// `CullingMethod::kEnhancedDualCone`: EDC with conditions that suffice. They are those of the normal cone test, but
/// contour edges are not compared within runs that advance along one direction; the runs take the place of the BNC.
/// Misses no pair.
///
/// @param test  memory to use again for every pose
template <int kSteps>
CulledPairs cull_by_enhanced_dual_cones(const Bvh& bvh, SurfacePieces& pieces,
                                        const typename SurfaceCones<kSteps>::Poses& poses,
                                        PlanarEmbeddingTest<kSteps>& test);

}  // namespace selvage
