#pragma once

#include "self_collision/culling/contour_kernel.h"
#include "self_collision/culling/surface_cones.h"

namespace selvage {

/// What EDC's ten tests say of a node whose children play the part of its quarters.
struct EnhancedDualConeResult {
  bool normals_pass = false;                          ///< condition 1; else nothing else is known
  std::uint8_t alone = 0;                             ///< children (bits) that pass condition 2
  std::array<std::uint8_t, BvhNode::kWidth> apart{};  ///< for each child those with which condition 3 holds

  bool does_clear(int child_count) const;
};

/// EDC's conditions 1 to 3 as published, in plain floating point. They are not sufficient.
template <int kSteps>
EnhancedDualConeResult test_enhanced_dual_cone(const Bvh& bvh, SurfacePieces& pieces, const SurfaceCones<kSteps>& cones,
                                               const std::array<std::span<const Vec3>, kSteps>& poses, Index node);

}  // namespace selvage
