#include "boundary_path/input/leaf_node.h"

#include "core/parallel.h"

namespace selvage {

template <int N>
void list_leaf_nodes(const Bvh& hierarchy, std::span<const VertexTuple<N>> primitives,
                     std::span<const std::uint8_t> is_on_boundary, std::vector<LeafNode<N>>& leaves) {
  const auto nodes = hierarchy.nodes();
  leaves.resize(nodes.size());
  parallel_for(std::ssize(nodes), 1024, [&](std::int64_t n) {
    LeafNode<N>& leaf = leaves[n];
    leaf = {};
    for (int i = nodes[n].child_count - 1; i >= 0 && nodes[n].children[i] >= 0; --i) {
      leaf.lanes |= 1u << i;
      const auto& vertices = primitives[nodes[n].children[i]];
      for (int k = 0; k < N; ++k) {
        leaf.vertices[k][i] = vertices[k];
        leaf.inner |= std::uint32_t{!is_on_boundary[vertices[k]]} << (BvhNode::kWidth * k + i);
      }
    }
    for (int i = 0; i < BvhNode::kWidth; ++i)
      for (int k = 0; k < N; ++k)
        if ((leaf.lanes >> i & 1) == 0) leaf.vertices[k][i] = leaf.vertices[0][nodes[n].child_count - 1];
  });
}

template void list_leaf_nodes<2>(const Bvh&, std::span<const VertexTuple<2>>, std::span<const std::uint8_t>,
                                 std::vector<LeafNode<2>>&);
template void list_leaf_nodes<3>(const Bvh&, std::span<const VertexTuple<3>>, std::span<const std::uint8_t>,
                                 std::vector<LeafNode<3>>&);
template void list_leaf_nodes<4>(const Bvh&, std::span<const VertexTuple<4>>, std::span<const std::uint8_t>,
                                 std::vector<LeafNode<4>>&);

}  // namespace selvage
