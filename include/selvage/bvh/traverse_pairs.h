#pragma once

#include "selvage/bvh/overlap.h"
#include "selvage/bvh/traverse.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace traversal {

/// Compares the children of two nodes, or for a self-pair those of one node with one another. Children that meet go to
/// `visit(primitive of a, primitive of b)`, or where both are nodes to `push(NodePair)`.
template <bool kSelf, typename Push, typename Visit>
SELVAGE_INLINE void compare_children(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair pair,
                                     Push&& push, Visit&& visit) {
  const BvhNode& a = nodes_a[pair.a];
  const BvhNode& b = nodes_b[pair.b];
  const bool same = kSelf && pair.a == pair.b;
  for (int i = 0; i < a.child_count; ++i) {
    const Index child_a = a.children[i];
    unsigned rest = overlapping_children(b, WideBox(a.box(i)));
    if (same) {
      rest &= ~0u << (i + 1);
      if (child_a < 0) push(NodePair{~child_a, ~child_a});
    }
    for (; rest != 0; rest &= rest - 1) {
      const int k = lowest_lane(rest);
      const Index child_b = b.children[k];
      if (child_a < 0 && child_b < 0)
        push(NodePair{~child_a, ~child_b});
      else if (child_b < 0)
        visit_overlaps(
            nodes_b, a.box(i), [&](Index primitive) { visit(child_a, primitive); }, NoCounter(), ~child_b);
      else if (child_a < 0)
        visit_overlaps(
            nodes_a, b.box(k), [&](Index primitive) { visit(primitive, child_b); }, NoCounter(), ~child_a);
      else
        visit(child_a, child_b);
    }
  }
}

template <bool kSelf, typename Visit>
inline void visit_pairs_below(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair start,
                              Visit&& visit) {
  if (nodes_a.empty() || nodes_b.empty()) return;
  // A popped pair leaves at most 8 x 8 where it was.
  NodePair stack[Bvh::kMaxLevels * (BvhNode::kWidth * BvhNode::kWidth - 1) + 1];
  stack[0] = start;
  NodePair* top = stack + 1;
  while (top != stack) {
    const NodePair pair = *--top;
    compare_children<kSelf>(
        nodes_a, nodes_b, pair, [&](NodePair next) { *top++ = next; }, visit);
  }
}

}  // namespace traversal

/// Visits each pair (primitive of a, primitive of b) whose boxes meet, borders included: those below a pair of nodes
/// (the roots unless told; see split_pair_work()).
///
/// @param visit  `visit(Index primitive_of_a, Index primitive_of_b)`
template <typename Visit>
inline void visit_pairs(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, Visit&& visit,
                        NodePair start = {0, 0}) {
  traversal::visit_pairs_below<false>(nodes_a, nodes_b, start, visit);
}

/// Visits each pair i < j of primitives of one hierarchy whose boxes meet, borders included, once: those below a pair
/// of nodes (all unless told; see split_self_pair_work()).
///
/// @param visit  `visit(Index i, Index j)`
template <typename Visit>
inline void visit_self_pairs(std::span<const BvhNode> nodes, Visit&& visit, NodePair start = {0, 0}) {
  traversal::visit_pairs_below<true>(nodes, nodes, start, [&](Index i, Index j) { i < j ? visit(i, j) : visit(j, i); });
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
