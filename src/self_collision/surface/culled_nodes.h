#pragma once

#include "bvh/overlap.h"
#include "core/simd/simd.h"

namespace selvage {

/// Pairs of nodes of one hierarchy that culling leaves out: nodes of its bounding volume test tree (BVTT).
struct CulledNodes {
  /// Per node N, not 0: (N, N) is culled. Null: none is.
  const std::uint8_t* self = nullptr;
  /// Per node N, bit i: the pair of N and its sibling number i is culled. Null: none is.
  const std::uint8_t* siblings = nullptr;

  SELVAGE_INLINE bool holds(const BvhNode* nodes, NodePair pair) const {
    if (pair.a == pair.b) return self != nullptr && self[pair.a] != 0;
    if (siblings == nullptr || nodes[pair.a].parent != nodes[pair.b].parent) return false;
    return (siblings[pair.a] >> (pair.b - ~nodes[nodes[pair.a].parent].children[0]) & 1) != 0;
  }
};

}  // namespace selvage
