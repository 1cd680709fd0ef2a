#include "bvh/refit.h"

#include "selvage/core/simd.h"

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

SELVAGE_INLINE ChildBounds bounds_of(const Box& box) {
  const float* const floats = reinterpret_cast<const float*>(&box);
  return {Float4::load(floats), Float4::load(floats + 2)};
}

SELVAGE_INLINE Float4 smaller_half(const float* row) {
  return min(Float4::load(row), Float4::load(row + 4));
}
SELVAGE_INLINE Float4 larger_half(const float* row) {
  return max(Float4::load(row), Float4::load(row + 4));
}

SELVAGE_INLINE ChildBounds bounds_of(const BvhNode& node) {
  const Float4 lower_z = smaller_half(node.lower[2]), upper_x = larger_half(node.upper[0]);
  return {reduce_min(smaller_half(node.lower[0]), smaller_half(node.lower[1]), lower_z, lower_z),
          reduce_max(upper_x, upper_x, larger_half(node.upper[1]), larger_half(node.upper[2]))};
}

/// Bounds of four children, a row for each axis.
struct FourBounds {
  Float4 lower[3];
  Float4 upper[3];
};

/// Bounds of children first ... first + 3.
SELVAGE_INLINE FourBounds gather_four(const BvhNode& node, const BvhNode* nodes, const Box* boxes, int first) {
  ChildBounds bounds[4];
  for (int i = 0; i < 4; ++i) {
    const Index child = node.children[first + i];
    if (first + i >= node.child_count)
      bounds[i] = {Float4::broadcast(kInfinity), Float4::broadcast(-kInfinity)};
    else
      bounds[i] = child < 0 ? bounds_of(nodes[~child]) : bounds_of(boxes[child]);
  }
  transpose(bounds[0].lower, bounds[1].lower, bounds[2].lower, bounds[3].lower);
  transpose(bounds[0].upper, bounds[1].upper, bounds[2].upper, bounds[3].upper);
  return {{bounds[0].lower, bounds[1].lower, bounds[2].lower}, {bounds[1].upper, bounds[2].upper, bounds[3].upper}};
}

/// Sets the bounds of all children and returns their measures.
SELVAGE_INLINE Float8 fit_node(BvhNode& node, const BvhNode* nodes, const Box* boxes, const BoxMeasure& measure) {
  const Float8 zero = Float8::broadcast(0), scale = Float8::broadcast(measure.scale);
  const Float8 largest = Float8::broadcast(std::numeric_limits<float>::max());
  const FourBounds left = gather_four(node, nodes, boxes, 0), right = gather_four(node, nodes, boxes, 4);
  Float8 extent[3];
  for (int axis = 0; axis < 3; ++axis) {
    const Float8 lower = Float8::join(left.lower[axis], right.lower[axis]);
    const Float8 upper = Float8::join(left.upper[axis], right.upper[axis]);
    lower.store(node.lower[axis]);
    upper.store(node.upper[axis]);
    extent[axis] = min(max(upper - lower, zero), largest) * scale;
  }
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

MeasureSums fit_nodes(BvhNode* nodes, const Box* boxes, Index first, Index last, const BoxMeasure& measure) {
  constexpr Index kAhead = 4;
  Float8 all = Float8::broadcast(0), inner = all;
  for (Index n = last - 1; n >= first; --n) {
    BvhNode& node = nodes[n];
    if (n - kAhead >= first)
      for (const Index child : nodes[n - kAhead].children)
        if (child >= 0) prefetch(boxes + child);
    const Float8 children = fit_node(node, nodes, boxes, measure);
    int inner_count = 0;
    for (int i = 0; i < BvhNode::kWidth; ++i) inner_count += node.children[i] < 0;
    all = all + children;
    inner = inner + keep_first(children, inner_count);
  }
  const double nodes_sum = sum_lanes(inner);
  return {nodes_sum, sum_lanes(all) - nodes_sum};
}

}  // namespace selvage
