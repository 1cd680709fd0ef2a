#pragma once

#include "bvh/overlap.h"
#include "bvh/traverse.h"
#include "core/simd/simd16.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// All of both hierarchies.
inline constexpr NodePair kRoots{0, 0, false, false};

/// Children of two nodes that are primitives and meet: bit 8 i + k stands for child i of the first and child k of the
/// second.
struct PrimitivePairs {
  Index first;
  Index second;
  std::uint64_t bits;
};

namespace traversal {

/// The bits of the rows of the first children, and of the columns of a mask of children.
SELVAGE_INLINE std::uint64_t rows_below(int count) {
  return count == 0 ? 0 : ~std::uint64_t{0} >> BvhNode::kWidth * (BvhNode::kWidth - count);
}
SELVAGE_INLINE std::uint64_t columns(unsigned children) {
  return children * std::uint64_t{0x0101010101010101};
}
inline constexpr std::uint64_t kAboveDiagonal = 0x0080c0e0f0f8fcfe;

/// The columns, or the rows, that have a bit.
SELVAGE_INLINE unsigned columns_in(std::uint64_t bits) {
  bits |= bits >> 32;
  bits |= bits >> 16;
  return static_cast<unsigned>(bits | bits >> 8) & 0xffu;
}
SELVAGE_INLINE unsigned rows_in(std::uint64_t bits) {
  unsigned rows = 0;
  for (int i = 0; i < BvhNode::kWidth; ++i)
    rows |= static_cast<unsigned>((bits >> BvhNode::kWidth * i & 0xff) != 0) << i;
  return rows;
}

/// Children that are nodes.
SELVAGE_INLINE unsigned inner_children(const BvhNode& node) {
  return less_bits(Float8::load(reinterpret_cast<const float*>(node.children)), Float8::broadcast(0)) & node.present();
}

/// Pairs of children that are primitives, absent ones among them.
SELVAGE_INLINE std::uint64_t primitive_pairs(const BvhNode& a, const BvhNode& b) {
  return ~rows_below(count_lanes(inner_children(a))) & ~columns(inner_children(b));
}

/// Which children of two nodes meet. All 64 pairs, and no branch: neighbours meet in most rows, never in the same ones.
SELVAGE_INLINE std::uint64_t meeting_children(const BvhNode& a, const BvhNode& b) {
  return pairs_that_meet(a.lower, a.upper, b.lower, b.upper) & rows_below(a.child_count) & columns(b.present());
}

/// Hands on pairs of children of two nodes, of those in the mask `meeting`: primitives to `visit(PrimitivePairs)`, even
/// where there are none, for whether there are is hard to predict; pairs with nodes to `push(NodePair)`: the primitives
/// of a node stay together.
template <typename Push, typename Visit>
SELVAGE_INLINE void hand_on_children(const BvhNode& a, const BvhNode& b, NodePair pair, std::uint64_t meeting,
                                     Push&& push, Visit&& visit) {
  const unsigned inner_a = inner_children(a), inner_b = inner_children(b);
  const std::uint64_t inner_rows = rows_below(count_lanes(inner_a)), inner_columns = columns(inner_b);
  visit(PrimitivePairs{pair.a, pair.b, meeting & ~inner_rows & ~inner_columns});
  if ((inner_a | inner_b) == 0) return;
  const auto node_a = [&](int i) { return ~a.children[i]; };
  const auto node_b = [&](int k) { return ~b.children[k]; };
  if (!pair.primitives_of_b)
    for (unsigned rest = columns_in(meeting & ~inner_rows & inner_columns); rest != 0; rest &= rest - 1)
      push(NodePair{pair.a, node_b(lowest_lane(rest)), true, false});
  if (pair.primitives_of_a) return;
  for (unsigned rest = rows_in(meeting & inner_rows & ~inner_columns); rest != 0; rest &= rest - 1)
    push(NodePair{node_a(lowest_lane(rest)), pair.b, false, true});
  if (pair.primitives_of_b) return;
  for (std::uint64_t rest = meeting & inner_rows & inner_columns; rest != 0; rest &= rest - 1) {
    const int bit = lowest_bit(rest);
    push(NodePair{node_a(bit / BvhNode::kWidth), node_b(bit % BvhNode::kWidth), false, false});
  }
}

/// Compares the children of two nodes, or for a self-pair those of one node with one another, and hands on those that
/// meet.
template <bool kSelf, typename Push, typename Visit>
SELVAGE_INLINE void compare_children(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair pair,
                                     Push&& push, Visit&& visit) {
  const BvhNode& a = nodes_a[pair.a];
  const BvhNode& b = nodes_b[pair.b];
  std::uint64_t meeting = meeting_children(a, b);
  if (kSelf && pair.a == pair.b) {
    meeting &= kAboveDiagonal;
    if (!pair.primitives_of_a && !pair.primitives_of_b)
      for (unsigned rest = inner_children(a); rest != 0; rest &= rest - 1) {
        const Index child = ~a.children[lowest_lane(rest)];
        push(NodePair{child, child, false, false});
      }
  }
  hand_on_children(a, b, pair, meeting, push, visit);
}

/// Calls `visit(primitive of a, primitive of b)` for each pair.
template <typename Visit>
SELVAGE_INLINE void visit_each(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b,
                               const PrimitivePairs& pairs, Visit&& visit) {
  for (std::uint64_t rest = pairs.bits; rest != 0; rest &= rest - 1) {
    const int bit = lowest_bit(rest);
    visit(nodes_a[pairs.first].children[bit / BvhNode::kWidth], nodes_b[pairs.second].children[bit % BvhNode::kWidth]);
  }
}

/// Visits the primitives whose boxes meet below a pair of nodes, those of two nodes together.
///
/// @param enter  `bool enter(NodePair)`: whether to look below a pair whose boxes meet
/// @param visit  `visit(const PrimitivePairs&)`
template <bool kSelf, typename Enter, typename Visit>
inline void visit_meeting(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair start,
                          Enter&& enter, Visit&& visit) {
  if (nodes_a.empty() || nodes_b.empty()) return;
  // Pairs that have been taken from the stack wait a little until their nodes are fetched, unless there are many.
  constexpr int kAhead = 8;
  constexpr std::ptrdiff_t kMany = 1024;
  constexpr int kMaxLeft = BvhNode::kWidth * BvhNode::kWidth;
  // One by one, a popped pair leaves at most 8 x 8 where it was, and each that it leaves is a level further down in a
  // or in b.
  NodePair stack[kMany + kAhead * kMaxLeft + Bvh::kMaxLevels * (kMaxLeft - 1) + 1];
  stack[0] = start;
  NodePair* top = stack + 1;
  NodePair ahead[kAhead];
  int first = 0, waiting = 0;
  for (;;) {
    while (top != stack && waiting < (top - stack < kMany ? kAhead : 1)) {
      const NodePair pair = *--top;
      if (!enter(pair)) continue;
      prefetch_node(nodes_a[pair.a]);
      prefetch_node(nodes_b[pair.b]);
      ahead[(first + waiting++) % kAhead] = pair;
    }
    if (waiting == 0) return;
    const NodePair pair = ahead[first];
    first = (first + 1) % kAhead;
    --waiting;
    compare_children<kSelf>(
        nodes_a, nodes_b, pair, [&](const NodePair& next) { *top++ = next; }, visit);
  }
}

template <bool kSelf, typename Visit>
inline void visit_pairs_below(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, NodePair start,
                              Visit&& visit) {
  visit_meeting<kSelf>(
      nodes_a, nodes_b, start, [](NodePair) { return true; },
      [&](const PrimitivePairs& pairs) { visit_each(nodes_a, nodes_b, pairs, visit); });
}

}  // namespace traversal

/// Visits each pair (primitive of a, primitive of b) whose boxes meet, borders included: those below a pair of nodes
/// (the roots unless told; see split_pair_work()).
///
/// @param visit  `visit(Index primitive_of_a, Index primitive_of_b)`
template <typename Visit>
inline void visit_pairs(std::span<const BvhNode> nodes_a, std::span<const BvhNode> nodes_b, Visit&& visit,
                        NodePair start = kRoots) {
  traversal::visit_pairs_below<false>(nodes_a, nodes_b, start, visit);
}

/// Visits each pair i < j of primitives of one hierarchy whose boxes meet, borders included, once: those below a pair
/// of nodes (all unless told; see split_self_pair_work()).
///
/// @param visit  `visit(Index i, Index j)`
template <typename Visit>
inline void visit_self_pairs(std::span<const BvhNode> nodes, Visit&& visit, NodePair start = kRoots) {
  traversal::visit_pairs_below<true>(nodes, nodes, start, [&](Index i, Index j) { i < j ? visit(i, j) : visit(j, i); });
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
