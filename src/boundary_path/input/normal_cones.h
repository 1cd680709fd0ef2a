#pragma once

#include "bvh/bvh.h"

namespace selvage {

/// An axis-aligned box of unit vectors: merging two loses nothing, unlike with cones. As Float8 loads it, with the
/// upper corner negated, so that one minimum merges two boxes.
struct alignas(32) NormalBox {
  std::array<float, 4> lower;
  std::array<float, 4> negated_upper;

  /// All directions; so is every box merged with it.
  static constexpr NormalBox everything() { return {{-2, -2, -2, 0}, {-2, -2, -2, 0}}; }
  static constexpr NormalBox nothing() { return {{2, 2, 2, 0}, {2, 2, 2, 0}}; }
};

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

}  // namespace selvage
