#pragma once

#include "bvh/bvh.h"
#include "core/simd/simd.h"

#include <limits>
#include <type_traits>

/// Queries of one box against a hierarchy: templates that inline what they call, allocate nothing and throw nothing.
/// Compile them in a kernel file (selvage_kernel() in CMake) to have the widest instructions.
namespace selvage {
inline namespace SELVAGE_ISA {

/// A counter that costs nothing.
struct NoCounter {
  SELVAGE_INLINE void operator++() const {}
};

/// A filter of children that keeps all.
struct KeepAll {
  SELVAGE_INLINE unsigned operator()(const BvhNode&, Index, unsigned children) const { return children; }
};

namespace traversal {

// A popped node leaves at most eight children where it was.
inline constexpr int kStackSize = Bvh::kMaxLevels * (BvhNode::kWidth - 1) + 1;

// A distance between boxes is computed with six roundings at most (difference, square, two sums, and two here), which
// is below 2^-21 of it, and tag_lanes() adds less than 2^-20. Where squares leave the normal floats, the error is below
// their smallest one. So limit and bound move apart by more than the sum.
inline constexpr float kRelativeSlack = 1.0f / (1 << 19);
inline constexpr float kAbsoluteSlack = std::numeric_limits<float>::min();

/// An upper bound of the computed squared distance where the true one is within the bound.
SELVAGE_INLINE float widen_bound(float squared_bound) {
  return squared_bound * (1.0f + kRelativeSlack) + kAbsoluteSlack;
}

/// A lower bound of the true squared distance.
SELVAGE_INLINE float lower_bound(float computed) {
  const float bound = computed * (1.0f - kRelativeSlack) - kAbsoluteSlack;
  return bound > 0 ? bound : 0;
}

struct WideBox {
  Float8 lower[3];
  Float8 upper[3];

  SELVAGE_INLINE explicit WideBox(const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = Float8::broadcast(box.lower[axis]);
      upper[axis] = Float8::broadcast(box.upper[axis]);
    }
  }
};

/// Squared distances between the box and each child, rounded to nearest.
SELVAGE_INLINE Float8 squared_distances(const BvhNode& node, const WideBox& box) {
  const Float8 zero = Float8::broadcast(0);
  Float8 gaps[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Float8 below = Float8::load(node.lower[axis]) - box.upper[axis];
    const Float8 above = box.lower[axis] - Float8::load(node.upper[axis]);
    gaps[axis] = max(max(below, above), zero);
  }
  return gaps[0] * gaps[0] + gaps[1] * gaps[1] + gaps[2] * gaps[2];
}

/// Children whose boxes meet the box, borders included.
SELVAGE_INLINE unsigned overlapping_children(const BvhNode& node, const WideBox& box) {
  const auto meet_along = [&](int axis) {
    return and_bits(less_equal_lanes(Float8::load(node.lower[axis]), box.upper[axis]),
                    less_equal_lanes(box.lower[axis], Float8::load(node.upper[axis])));
  };
  return sign_bits(and_bits(and_bits(meet_along(0), meet_along(1)), meet_along(2))) & node.present();
}

SELVAGE_INLINE void prefetch_node(const BvhNode& node) {
  for (std::size_t line = 0; line < sizeof(BvhNode); line += 64) prefetch(reinterpret_cast<const char*>(&node) + line);
}

/// A child waiting for its turn: the squared distance, which sorts, above the child's code.
SELVAGE_INLINE std::uint64_t pack(float squared_distance, Index child) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(squared_distance)} << 32 | static_cast<std::uint32_t>(child);
}
SELVAGE_INLINE float distance_of(std::uint64_t waiting) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(waiting >> 32));
}
SELVAGE_INLINE Index child_of(std::uint64_t waiting) {
  return static_cast<Index>(static_cast<std::uint32_t>(waiting));
}

/// Puts the children of a node that are within the limit on the stack, the nearest on top. Returns the new top.
template <typename Filter>
SELVAGE_INLINE std::uint64_t* push_near_children(std::span<const BvhNode> nodes, Index place, const WideBox& box,
                                                 float limit, std::uint64_t* top, Filter& filter) {
  const BvhNode& node = nodes[place];
  const Float8 computed = squared_distances(node, box);
  const unsigned within = less_equal(computed, Float8::broadcast(limit)) & node.present();
  const unsigned near = filter(node, place, within);
  // Distinct keys: a child's place is the number of nearer ones, found without a branch.
  const Float8 keys = tag_lanes(min(computed, Float8::broadcast(std::numeric_limits<float>::max())));
  alignas(32) float distances[BvhNode::kWidth];
  keys.store(distances);
  std::uint64_t* const last = top + count_lanes(near) - 1;
  for (unsigned rest = near; rest != 0; rest &= rest - 1) {
    const int lane = lowest_lane(rest);
    const Index child = node.children[lane];
    const int nearer = count_lanes(less_bits(keys, Float8::broadcast(distances[lane])) & near);
    last[-nearer] = pack(distances[lane], child);
    if (child < 0) prefetch_node(nodes[~child]);
  }
  return last + 1;
}

}  // namespace traversal

/// Visits the primitives that can be within a distance of a point, nearest first by and large.
///
/// @param nodes          of a Bvh
/// @param point          the point, as a box rounded outward, or any box; not empty
/// @param squared_bound  primitives whose box is farther need no visit [m^2]; infinity is allowed
/// @param visit          `float visit(Index primitive, float squared_distance)` is told a lower bound of the squared
///                       distance between the point and the primitive's box, and returns the new squared bound (see
///                       round_up() in box.h), usually a smaller one; a negative one ends the search
/// @param counter        `++counter` for each node visited
/// @param filter         `unsigned filter(const BvhNode&, Index place, unsigned children)` returns those of a node's
///                       children (bits) that are worth a visit: for a reason of the caller's beside distance
///
/// No primitive is missed whose box is within the bound when its turn comes: the bound is widened by more than all
/// rounding. A primitive a few units in the last place outside it may be visited too. Depth-first, children sorted.
template <typename Visit, typename Counter = NoCounter, typename Filter = KeepAll>
inline void visit_nearest(std::span<const BvhNode> nodes, const Box& point, float squared_bound, Visit&& visit,
                          Counter&& counter = {}, Filter&& filter = {}) {
  if (nodes.empty()) return;
  const traversal::WideBox box(point);
  float limit = traversal::widen_bound(squared_bound);
  std::uint64_t stack[traversal::kStackSize];
  stack[0] = traversal::pack(0, ~Index{0});
  std::uint64_t* top = stack + 1;
  while (top != stack) {
    const std::uint64_t waiting = *--top;
    const float distance = traversal::distance_of(waiting);
    if (!(distance <= limit)) continue;
    const Index child = traversal::child_of(waiting);
    if (child < 0) {
      ++counter;
      top = traversal::push_near_children(nodes, ~child, box, limit, top, filter);
    } else {
      limit = traversal::widen_bound(visit(child, traversal::lower_bound(distance)));
    }
  }
}

/// Visits all primitives whose boxes meet the query box, borders included, below one node (the root unless told).
///
/// @param visit  `visit(Index primitive)`; where it returns bool, false ends the search
template <typename Visit, typename Counter = NoCounter>
inline void visit_overlaps(std::span<const BvhNode> nodes, const Box& query, Visit&& visit, Counter&& counter = {},
                           Index start = 0) {
  if (nodes.empty()) return;
  const traversal::WideBox box(query);
  Index stack[traversal::kStackSize];
  stack[0] = start;
  Index* top = stack + 1;
  while (top != stack) {
    const BvhNode& node = nodes[*--top];
    ++counter;
    for (unsigned rest = traversal::overlapping_children(node, box); rest != 0; rest &= rest - 1) {
      const Index child = node.children[lowest_lane(rest)];
      if (child < 0) {
        *top++ = ~child;
      } else if constexpr (std::is_same_v<decltype(visit(child)), bool>) {
        if (!visit(child)) return;
      } else {
        visit(child);
      }
    }
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
