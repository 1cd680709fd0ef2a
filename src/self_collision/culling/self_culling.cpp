#include "self_collision/culling/self_culling.h"

#include "self_collision/culling/dual_cone.h"
#include "self_collision/culling/enhanced_dual_cone.h"
#include "self_collision/culling/normal_cone.h"

namespace selvage {

template <int kSteps>
CulledPairs cull_self_pairs(const SelfCollisionOptions& options, const Bvh& bvh, SurfacePieces& pieces,
                            const typename PlanarEmbeddingTest<kSteps>::Poses& poses, PlanarEmbeddingTest<kSteps>& test,
                            std::span<const MovingVertex> rounded, bool knows_neighbours) {
  if (bvh.nodes().empty()) return {};
  switch (options.method) {
    case CullingMethod::kBvh:
      return {};
    case CullingMethod::kNormalCone:
      return cull_by_normal_cones<kSteps>(ContourTest::kAllEdges, bvh, pieces, poses, test);
    case CullingMethod::kDualCone:
      return cull_by_dual_cones<kSteps>(ContourEdges::kBorder, bvh, pieces, poses);
    case CullingMethod::kDualConeInternal:
      return cull_by_dual_cones<kSteps>(ContourEdges::kBorderAndInternal, bvh, pieces, poses);
    case CullingMethod::kEnhancedDualCone:
      return cull_by_enhanced_dual_cones<kSteps>(bvh, pieces, poses, test);
    case CullingMethod::kEnhancedDualConePublished:
      return cull_by_enhanced_dual_cones_as_published<kSteps>(options.simple_traversal, bvh, pieces, poses);
    case CullingMethod::kAuto:
      return cull_by_planar_embedding<kSteps>(bvh, pieces, poses, rounded, knows_neighbours, test);
  }
  return {};
}

template CulledPairs cull_self_pairs<1>(const SelfCollisionOptions&, const Bvh&, SurfacePieces&,
                                        const PlanarEmbeddingTest<1>::Poses&, PlanarEmbeddingTest<1>&,
                                        std::span<const MovingVertex>, bool);
template CulledPairs cull_self_pairs<2>(const SelfCollisionOptions&, const Bvh&, SurfacePieces&,
                                        const PlanarEmbeddingTest<2>::Poses&, PlanarEmbeddingTest<2>&,
                                        std::span<const MovingVertex>, bool);

}  // namespace selvage
