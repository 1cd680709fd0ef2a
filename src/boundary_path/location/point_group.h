#pragma once

#include "boundary_path/location/containment_kernel.h"
#include "bvh/traverse.h"
#include "core/simd/simd16.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Up to sixteen points that lie near each other, to be compared with boxes.
///
/// Boxes of all children of a node are compared at once, on a grid of 32 cells along each axis around the points. Masks
/// for each cell say which points lie in it or beyond: the points between the cells of a box's lower and upper side are
/// those that may lie in the box.
class PointGroup {
 public:
  PointGroup() = default;

  SELVAGE_INLINE PointGroup(const RoundedPosition* rounded, std::span<const Index> ids, float rounding) {
    const int count = static_cast<int>(ids.size());
    alignas(64) float x[3][kPacketSize];
    for (int i = 0; i < kPacketSize; ++i)
      for (int axis = 0; axis < 3; ++axis) x[axis][i] = rounded[ids[i < count ? i : count - 1]][axis];
    present_ = 0xffffu >> (kPacketSize - count);
    Float4 low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      position_[axis] = Float16::load(x[axis]);
      lower_[axis] = position_[axis] - Float16::broadcast(2 * rounding);
      upper_[axis] = position_[axis] + Float16::broadcast(2 * rounding);
      const Float8 a = Float8::load(x[axis]), b = Float8::load(x[axis] + 8);
      low[axis] = min(min(a, b).low(), min(a, b).high());
      high[axis] = max(max(a, b).low(), max(a, b).high());
    }
    float least[4], greatest[4];
    reduce_min(low[0], low[1], low[2], low[2]).store(least);
    reduce_max(high[0], high[1], high[2], high[2]).store(greatest);
    for (int axis = 0; axis < 3; ++axis) lay_grid(axis, least[axis], greatest[axis], rounding);
  }

  const Float16* position() const { return position_; }

  /// For each child of a node the points that may lie in its box, and perhaps some that lie a cell beside it.
  SELVAGE_INLINE Int8 near_children(const BvhNode& node) const {
    const Float8 zero = Float8::broadcast(0), last = Float8::broadcast(kCells - 1);
    Float8 lower[3], upper[3];
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 scale = Float8::broadcast(scale_[axis]);
      lower[axis] = (Float8::load(node.lower[axis]) - Float8::broadcast(lower_origin_[axis])) * scale;
      upper[axis] = (Float8::load(node.upper[axis]) - Float8::broadcast(upper_origin_[axis])) * scale;
      lower[axis] = min(max(lower[axis], zero), last);
      upper[axis] = min(max(upper[axis], zero), last);
    }
    return masks_between(at_or_beyond_, lower, upper);
  }

  /// Which of some points may lie in one child's box: none that lies beside it by more than rounding.
  SELVAGE_INLINE unsigned in_child(const BvhNode& node, int child, unsigned points) const {
    for (int axis = 0; axis < 3; ++axis) {
      points = less_equal(lower_[axis], Float16::broadcast(node.upper[axis][child]), points);
      points = less_equal(Float16::broadcast(node.lower[axis][child]), upper_[axis], points);
    }
    return points;
  }

 private:
  static constexpr int kCells = 32;

  /// The points lie in cells 1 to 30, so that boxes beyond them are told from boxes around them. A box's lower side
  /// must come to the cell of a point upon it or to one before, its upper side to a cell after: they are moved apart by
  /// more than all rounding, and the upper one by another cell. A cell is wider than `rounding` by a factor of eight.
  SELVAGE_INLINE void lay_grid(int axis, float least, float greatest, float rounding) {
    const float cell = (greatest - least + 256 * rounding + 1e-30f) / (kCells - 3);
    const float origin = least - 1.5f * cell, apart = 4 * rounding + 0x1p-10f * cell;
    scale_[axis] = 1 / cell;
    lower_origin_[axis] = origin + apart;
    upper_origin_[axis] = origin - apart - cell;
    const Float16 place = (position_[axis] - Float16::broadcast(origin)) * Float16::broadcast(scale_[axis]);
    for (int i = 0; i < kCells; ++i)
      at_or_beyond_[axis][i] =
          static_cast<std::uint16_t>(less_equal(Float16::broadcast(static_cast<float>(i)), place, present_));
  }

  Float16 position_[3];
  Float16 lower_[3], upper_[3];  ///< boxes that hold the exact points
  alignas(64) AxisMasks at_or_beyond_;
  float scale_[3], lower_origin_[3], upper_origin_[3];
  unsigned present_;  ///< lanes with a point
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
