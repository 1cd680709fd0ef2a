#pragma once

#include "bvh/overlap.h"
#include "core/simd/simd.h"

namespace selvage {

/// Pairs of nodes of one hierarchy that are left out: by culling, which are nodes of its bounding volume test tree
/// (BVTT), or because nothing below them has strayed.
struct CulledNodes {
  /// Per node N, not 0: (N, N) is culled. Null: none is.
  const std::uint8_t* self = nullptr;
  /// Per node N, bit i: the pair of N and its sibling number i is culled. Null: none is.
  const std::uint8_t* siblings = nullptr;

  /// Per node, bit i: something below child i has strayed, so that it is compared. Null: everything is compared.
  const std::uint8_t* strayed = nullptr;

  /// Those among the pairs of children of two nodes that have strayed.
  SELVAGE_INLINE std::uint64_t strayed_among(Index a, Index b, std::uint64_t bits) const {
    if (strayed == nullptr) return bits;
    std::uint64_t either = strayed[b] * std::uint64_t{0x0101010101010101};
    for (int i = 0; i < BvhNode::kWidth; ++i)
      if ((strayed[a] >> i & 1) != 0) either |= std::uint64_t{0xff} << BvhNode::kWidth * i;
    return bits & either;
  }

  SELVAGE_INLINE bool holds(const BvhNode* nodes, NodePair pair) const {
    if (strayed != nullptr && (strayed[pair.a] | strayed[pair.b]) == 0) return true;
    if (pair.a == pair.b) return self != nullptr && self[pair.a] != 0;
    if (siblings == nullptr || nodes[pair.a].parent != nodes[pair.b].parent) return false;
    return (siblings[pair.a] >> (pair.b - ~nodes[nodes[pair.a].parent].children[0]) & 1) != 0;
  }
};

}  // namespace selvage
