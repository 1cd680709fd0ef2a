#include "bvh/refit.h"

#include "core/simd/simd.h"

#include <limits>

namespace selvage {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Bounds of one child: (lower x, y, z, any) and (any, upper x, y, z), as two loads find them in the six floats of a
/// Box.
struct ChildBounds {
  Float4 lower;
  Float4 upper;
};

SELVAGE_INLINE ChildBounds child_bounds(const Box& box) {
  const float* const floats = reinterpret_cast<const float*>(&box);
  return {Float4::load(floats), Float4::load(floats + 2)};
}

SELVAGE_INLINE Float4 smaller_half(const float* row) {
  return min(Float4::load(row), Float4::load(row + 4));
}
SELVAGE_INLINE Float4 larger_half(const float* row) {
  return max(Float4::load(row), Float4::load(row + 4));
}

SELVAGE_INLINE ChildBounds child_bounds(const BvhNode& node) {
  const Float4 lower_z = smaller_half(node.lower[2]), upper_x = larger_half(node.upper[0]);
  return {reduce_min(smaller_half(node.lower[0]), smaller_half(node.lower[1]), lower_z, lower_z),
          reduce_max(upper_x, upper_x, larger_half(node.upper[1]), larger_half(node.upper[2]))};
}

/// Bounds of four children, a row for each axis.
struct FourBounds {
  Float4 lower[3];
  Float4 upper[3];
};

/// Bounds of children first ... first + 3, as `bounds_of_child(lane)` gives them.
template <typename BoundsOfChild>
SELVAGE_INLINE FourBounds gather_four(int first, BoundsOfChild&& bounds_of_child) {
  ChildBounds bounds[4];
  for (int i = 0; i < 4; ++i) bounds[i] = bounds_of_child(first + i);
  transpose(bounds[0].lower, bounds[1].lower, bounds[2].lower, bounds[3].lower);
  transpose(bounds[0].upper, bounds[1].upper, bounds[2].upper, bounds[3].upper);
  return {{bounds[0].lower, bounds[1].lower, bounds[2].lower}, {bounds[1].upper, bounds[2].upper, bounds[3].upper}};
}

SELVAGE_INLINE ChildBounds no_bounds() {
  return {Float4::broadcast(kInfinity), Float4::broadcast(-kInfinity)};
}

SELVAGE_INLINE int inner_children(const BvhNode& node) {
  int count = 0;
  for (const Index child : node.children) count += child < 0;
  return count;
}

/// Takes in the bounds of child nodes, which come first.
SELVAGE_INLINE void merge_inner_children(BvhNode& node, const BvhNode* nodes, int inner_count) {
  for (int first = 0; first < inner_count; first += 4) {
    const FourBounds four = gather_four(
        first, [&](int lane) { return lane < inner_count ? child_bounds(nodes[~node.children[lane]]) : no_bounds(); });
    for (int axis = 0; axis < 3; ++axis) {
      min(four.lower[axis], Float4::load(node.lower[axis] + first)).store(node.lower[axis] + first);
      max(four.upper[axis], Float4::load(node.upper[axis] + first)).store(node.upper[axis] + first);
    }
  }
}

SELVAGE_INLINE Float8 measure_children(const BvhNode& node, const BoxMeasure& measure) {
  const Float8 zero = Float8::broadcast(0), scale = Float8::broadcast(measure.scale);
  const Float8 largest = Float8::broadcast(std::numeric_limits<float>::max());
  Float8 extent[3];
  for (int axis = 0; axis < 3; ++axis)
    extent[axis] = min(max(Float8::load(node.upper[axis]) - Float8::load(node.lower[axis]), zero), largest) * scale;
  if (measure.flat) return extent[0] + extent[1] + extent[2];
  return extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0];
}

SELVAGE_INLINE double sum_lanes(Float8 a) {
  alignas(32) float lanes[8];
  a.store(lanes);
  double sum = 0;
  for (const float lane : lanes) sum += lane;
  return sum;
}

}  // namespace

void fill_boxes(BvhNode* nodes, const Box* boxes, Index first, Index last) {
  constexpr Index kAhead = 4;
  for (Index n = first; n < last; ++n) {
    BvhNode& node = nodes[n];
    if (n + kAhead < last)
      for (const Index child : nodes[n + kAhead].children)
        if (child >= 0) prefetch(boxes + child);
    for (int half = 0; half < BvhNode::kWidth; half += 4) {
      const FourBounds four = gather_four(half, [&](int lane) {
        return lane < node.child_count && node.children[lane] >= 0 ? child_bounds(boxes[node.children[lane]])
                                                                   : no_bounds();
      });
      for (int axis = 0; axis < 3; ++axis) {
        four.lower[axis].store(node.lower[axis] + half);
        four.upper[axis].store(node.upper[axis] + half);
      }
    }
  }
}

MeasureSums fit_nodes(BvhNode* nodes, Index first, Index last, const BoxMeasure& measure) {
  Float8 all = Float8::broadcast(0), inner = all;
  for (Index n = first; n < last; ++n) {
    const int inner_count = inner_children(nodes[n]);
    merge_inner_children(nodes[n], nodes, inner_count);
    const Float8 children = measure_children(nodes[n], measure);
    all = all + children;
    inner = inner + keep_first(children, inner_count);
  }
  const double nodes_sum = sum_lanes(inner);
  return {nodes_sum, sum_lanes(all) - nodes_sum};
}

}  // namespace selvage
