#pragma once

#include "bvh/bvh.h"

namespace selvage {

/// Vertices of the primitives in one node of a hierarchy, lane by lane. Lanes that hold no primitive repeat a vertex
/// that exists, so that all eight can be computed with.
template <int N>
struct alignas(32) LeafNode {
  Index vertices[N][BvhNode::kWidth];  ///< vertex k of child i
  unsigned lanes;                      ///< children that are primitives
  std::uint32_t inner;                 ///< bit 8 k + i: vertex k of child i is not on the boundary
};

/// One entry a node of the hierarchy over `primitives`.
///
/// @param is_on_boundary  per vertex
template <int N>
void list_leaf_nodes(const Bvh& hierarchy, std::span<const VertexTuple<N>> primitives,
                     std::span<const std::uint8_t> is_on_boundary, std::vector<LeafNode<N>>& leaves);

extern template void list_leaf_nodes<2>(const Bvh&, std::span<const VertexTuple<2>>, std::span<const std::uint8_t>,
                                        std::vector<LeafNode<2>>&);
extern template void list_leaf_nodes<3>(const Bvh&, std::span<const VertexTuple<3>>, std::span<const std::uint8_t>,
                                        std::vector<LeafNode<3>>&);
extern template void list_leaf_nodes<4>(const Bvh&, std::span<const VertexTuple<4>>, std::span<const std::uint8_t>,
                                        std::vector<LeafNode<4>>&);

}  // namespace selvage
