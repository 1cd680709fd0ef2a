#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// All unit vectors within an angle of an axis.
struct NormalCone {
  std::array<float, 3> axis{0, 0, 0};
  float cosine = -1;  ///< of the half angle, rounded so that the cone grows; -1: all directions

  static NormalCone everything() { return {}; }
  bool is_bounded() const { return cosine > -1; }
};

/// Smallest cone that this simple rule finds around others: its axis is their average.
NormalCone merge_cones(std::span<const NormalCone> cones);

/// For each child of a node of the hierarchy over boundary faces a cone that contains the outward normals of all
/// boundary faces at the vertices of the faces below the child.
///
/// Why: let s be the closest boundary point, x = p - s, and all these normals lie within an angle a < 90 degrees of an
/// axis. Around s the boundary is then a graph over the plane across the axis with slopes up to tan a, in every
/// horizontal direction, and x makes no acute angle with any direction of the boundary at s: so x lies within a of the
/// axis or of its opposite. When a < 45 degrees and x lies within a of the axis itself, it points out of the material,
/// and the segment cannot be a valid path. So x lies within a of the opposite of the axis, and a child can be skipped
/// when no point of its box sees p in such a direction. This is infeasible-region culling (SPB section 3.6) of whole
/// subtrees; it holds where that holds.
struct alignas(32) ConeNode {
  float axis[3][BvhNode::kWidth];
  float cosine[BvhNode::kWidth];  ///< 0, like sine, where the normals are not bounded: then no child is skipped
  float sine[BvhNode::kWidth];
  unsigned two_sided;  ///< children whose cones are too wide to tell inside from outside
};

/// @param vertex_cones  per vertex the cone of its boundary faces' normals; unbounded where nothing may be culled
template <int D>
void fit_cones(const Bvh& faces, const SimplexMesh<D>& mesh, std::span<const NormalCone> vertex_cones,
               std::vector<ConeNode>& nodes);

extern template void fit_cones<2>(const Bvh&, const SimplexMesh<2>&, std::span<const NormalCone>,
                                  std::vector<ConeNode>&);
extern template void fit_cones<3>(const Bvh&, const SimplexMesh<3>&, std::span<const NormalCone>,
                                  std::vector<ConeNode>&);

}  // namespace selvage
