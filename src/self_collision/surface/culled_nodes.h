#pragma once

#include "bvh/overlap.h"
#include "core/simd/simd.h"

namespace selvage {

/// Pairs of nodes of one hierarchy that culling leaves out.
struct CulledNodes {
  const std::uint8_t* cleared = nullptr;  ///< per node, not 0: needs no comparison with itself; null: none
  const std::uint8_t* siblings =
      nullptr;  ///< per node its siblings, by their number, that it need not be compared with

  SELVAGE_INLINE bool do_hold(const BvhNode* nodes, NodePair pair) const {
    if (pair.a == pair.b) return cleared != nullptr && cleared[pair.a] != 0;
    if (siblings == nullptr || nodes[pair.a].parent != nodes[pair.b].parent) return false;
    return (siblings[pair.a] >> (pair.b - ~nodes[nodes[pair.a].parent].children[0]) & 1) != 0;
  }
};

}  // namespace selvage
