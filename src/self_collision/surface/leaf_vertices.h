#pragma once

#include "bvh/bvh.h"

#include <bit>

namespace selvage {

/// Vertices of the children of a node that are triangles, one row a corner, so that eight are compared at once.
struct alignas(32) LeafVertices {
  Index corners[3][BvhNode::kWidth];
};

inline namespace SELVAGE_ISA {

/// Children of two nodes that have a vertex in common, as bits of pairs.
SELVAGE_INLINE std::uint64_t sharing_pairs(const LeafVertices& a, const LeafVertices& b) {
  const auto corners = [](const LeafVertices& leaves, int l) {
    return Float8::load(reinterpret_cast<const float*>(leaves.corners[l]));
  };
  const Float8 of_b[3] = {corners(b, 0), corners(b, 1), corners(b, 2)};
  std::uint64_t bits = 0;
  for (int i = 0; i < BvhNode::kWidth; ++i) {
    Float8 lanes = Float8::broadcast(0);
    for (int k = 0; k < 3; ++k) {
      const Float8 corner = Float8::broadcast(std::bit_cast<float>(a.corners[k][i]));
      for (int l = 0; l < 3; ++l) lanes = or_bits(lanes, equal_lanes(corner, of_b[l]));
    }
    bits |= std::uint64_t{sign_bits(lanes)} << BvhNode::kWidth * i;
  }
  return bits;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
