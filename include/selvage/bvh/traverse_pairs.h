#pragma once

#include "selvage/bvh/overlap.h"
#include "selvage/bvh/traverse.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// A primitive of one hierarchy, and the primitives among the children of one node of the other that it meets.
struct PrimitiveRow {
  Index primitive;
  Index node;      ///< place of the node
  unsigned lanes;  ///< which of its children
  bool swapped;    ///< the primitive is one of the second hierarchy, the node one of the first
};

namespace traversal {

/// Children that are nodes.
SELVAGE_INLINE unsigned inner_children(const BvhNode& node) {
  return less_bits(Float8::load(reinterpret_cast<const float*>(node.children)), Float8::broadcast(0)) & node.present();
}

/// Children of node a that can meet a child of node b: they meet the box that the parent of b has for it.
SELVAGE_INLINE unsigned children_near(const BvhNode& a, std::span<const BvhNode> nodes_b, Index b) {
  const Index parent = nodes_b[b].parent;
  if (parent == kNone) return a.present();
  return overlapping_children(a, WideBox(nodes_b[parent].box(b - ~nodes_b[parent].children[0])));
}

/// Visits the primitives below a node whose boxes meet the query box, those of one node together.
template <typename Visit>
inline void visit_overlap_lanes(std::span<const BvhNode> nodes, const Box& query, Index start, Visit&& visit) {
  const WideBox box(query);
  Index stack[kStackSize];
  stack[0] = start;
  Index* top = stack + 1;
  while (top != stack) {
    const Index place = *--top;
    const BvhNode& node = nodes[place];
    const unsigned meeting = overlapping_children(node, box), inner = inner_children(node);
    for (unsigned rest = meeting & inner; rest != 0; rest &= rest - 1) *top++ = ~node.children[lowest_lane(rest)];
    if ((meeting & ~inner) != 0) visit(place, meeting & ~inner);
  }
}

/// Compares the children of two nodes, or for a self-pair those of one node with one another. Children that meet go to
/// `visit(PrimitiveRow)`, or where both are nodes to `push(NodePair)`.
template <bool kSelf, typename Push, typename Visit>
SELVAGE_INLINE void compare_children(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair pair,
                                     Push&& push, Visit&& visit) {
  const BvhNode& a = nodes_a[pair.a];
  const BvhNode& b = nodes_b[pair.b];
  const bool same = kSelf && pair.a == pair.b;
  const unsigned inner = inner_children(b);
  for (unsigned rows = same ? a.present() : children_near(a, nodes_b, pair.b); rows != 0; rows &= rows - 1) {
    const int i = lowest_lane(rows);
    const Index child_a = a.children[i];
    const Box box_a = a.box(i);
    unsigned meeting = overlapping_children(b, WideBox(box_a));
    if (same) {
      meeting &= ~0u << (i + 1);
      if (child_a < 0) push(NodePair{~child_a, ~child_a});
    }
    if (child_a >= 0) {
      if ((meeting & ~inner) != 0) visit(PrimitiveRow{child_a, pair.b, meeting & ~inner, false});
      for (unsigned rest = meeting & inner; rest != 0; rest &= rest - 1)
        visit_overlap_lanes(nodes_b, box_a, ~b.children[lowest_lane(rest)], [&](Index place, unsigned lanes) {
          visit(PrimitiveRow{child_a, place, lanes, false});
        });
      continue;
    }
    for (unsigned rest = meeting & inner; rest != 0; rest &= rest - 1)
      push(NodePair{~child_a, ~b.children[lowest_lane(rest)]});
    for (unsigned rest = meeting & ~inner; rest != 0; rest &= rest - 1) {
      const int k = lowest_lane(rest);
      visit_overlap_lanes(nodes_a, b.box(k), ~child_a, [&](Index place, unsigned lanes) {
        visit(PrimitiveRow{b.children[k], place, lanes, true});
      });
    }
  }
}

/// Calls `visit(primitive of a, primitive of b)` for each pair of a row.
template <typename Visit>
SELVAGE_INLINE void visit_row(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b,
                              const PrimitiveRow& row, Visit&& visit) {
  const BvhNode& node = (row.swapped ? nodes_a : nodes_b)[row.node];
  for (unsigned rest = row.lanes; rest != 0; rest &= rest - 1) {
    const Index other = node.children[lowest_lane(rest)];
    row.swapped ? visit(other, row.primitive) : visit(row.primitive, other);
  }
}

/// Visits the rows of primitives whose boxes meet below a pair of nodes.
///
/// @param enter  `bool enter(NodePair)`: whether to look below a pair whose boxes meet
/// @param visit  `visit(const PrimitiveRow&)`
template <bool kSelf, typename Enter, typename Visit>
inline void visit_rows(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair start,
                       Enter&& enter, Visit&& visit) {
  if (nodes_a.empty() || nodes_b.empty()) return;
  // A popped pair leaves at most 8 x 8 where it was.
  NodePair stack[Bvh::kMaxLevels * (BvhNode::kWidth * BvhNode::kWidth - 1) + 1];
  stack[0] = start;
  NodePair* top = stack + 1;
  while (top != stack) {
    const NodePair pair = *--top;
    if (enter(pair))
      compare_children<kSelf>(
          nodes_a, nodes_b, pair, [&](NodePair next) { *top++ = next; }, visit);
  }
}

template <bool kSelf, typename Visit>
inline void visit_pairs_below(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair start,
                              Visit&& visit) {
  visit_rows<kSelf>(
      nodes_a, nodes_b, start, [](NodePair) { return true; },
      [&](const PrimitiveRow& row) { visit_row(nodes_a, nodes_b, row, visit); });
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
