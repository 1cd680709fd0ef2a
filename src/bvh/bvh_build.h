#pragma once

#include "bvh/bvh.h"
#include "core/unset_vector.h"

namespace selvage {

/// A tree without bounds.
struct BvhTopology {
  UnsetVector<BvhNode> nodes;  ///< children, parents and counts are set, bounds are not
  std::vector<Index> levels;
  bool flat;             ///< all boxes lie in a plane across an axis
  float largest_extent;  ///< of the box of all primitives
};

/// Builds the nodes over at least one primitive.
BvhTopology build_topology(std::span<const Box> boxes, BuildQuality quality);

}  // namespace selvage
