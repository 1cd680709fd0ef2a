#include "self_collision/culling/dual_cone.h"

#include <cmath>
#include <numbers>

namespace selvage {

namespace {

/// BNC of the contour edges of a node that are not on the border of the whole surface.
template <int kSteps>
DirectionCone internal_binormals(SurfacePieces& pieces, const SurfaceCones<kSteps>& cones, Index node) {
  DirectionCone internal;
  std::vector<char> workspace;
  for (const Index edge : pieces.contours(node, workspace).edges)
    if (pieces.opposite(edge) != kNone) internal.merge(cones.binormals(edge));
  return internal;
}

}  // namespace

bool passes_dual_cone_test(const DirectionCone& normals, const DirectionCone& binormals) {
  if (!(normals.angle < std::numbers::pi / 2)) return false;
  return binormals.is_empty() || std::abs(normals.axis.dot(binormals.axis)) < std::cos(binormals.angle);
}

template <int kSteps>
CulledPairs cull_by_dual_cones(ContourEdges edges, const Bvh& bvh, SurfacePieces& pieces,
                               const typename SurfaceCones<kSteps>::Poses& poses) {
  const SurfaceCones<kSteps> cones(bvh, pieces, poses);
  CulledPairs culled;
  cull_from_root<NoWorkspace>(bvh, pieces, 1, culled, [&](Index node, NoWorkspace&) {
    if (edges == ContourEdges::kBorder) return passes_dual_cone_test(cones.normals(node), cones.border_binormals(node));
    return bvh.nodes()[node].children[0] < 0 &&
           passes_dual_cone_test(cones.normals(node), cones.border_binormals(node)) &&
           passes_dual_cone_test(cones.normals(node), internal_binormals(pieces, cones, node));
  });
  return culled;
}

template CulledPairs cull_by_dual_cones<1>(ContourEdges, const Bvh&, SurfacePieces&, const SurfaceCones<1>::Poses&);
template CulledPairs cull_by_dual_cones<2>(ContourEdges, const Bvh&, SurfacePieces&, const SurfaceCones<2>::Poses&);

}  // namespace selvage
