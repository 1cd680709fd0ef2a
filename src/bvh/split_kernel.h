#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"

namespace selvage {

/// A primitive while the tree is built: its box (clamped to finite numbers), in one load of eight floats. The upper
/// corner is negated, so that one minimum merges two boxes.
struct alignas(16) PrimitiveRef {
  float lower[3];
  Index primitive;
  float negated_upper[3];
  float unused;

  /// Twice the centre.
  float centre(int axis) const { return lower[axis] - negated_upper[axis]; }
};

/// Bounds, as a PrimitiveRef holds them, and counts of the primitives in each bin of each axis.
struct SplitBins {
  static constexpr int kCount = 16;
  alignas(32) float bounds[3][kCount][8];
  Index counts[3][kCount];
};

/// From twice the centre of a primitive to its bins.
struct BinScale {
  float origin[4];
  float scale[4];
};

/// The primitives whose centres lie in bins below a plane.
struct LeftSide {
  int axis;
  float origin;
  float scale;
  float first_right_bin;

  bool holds(const PrimitiveRef& ref) const { return (ref.centre(axis) - origin) * scale < first_right_bin; }
};

/// A plane between two bins: primitives in bins below `first_right_bin` go left. Axis -1: none parts the primitives.
struct SplitPlane {
  int axis = -1;
  int first_right_bin = 0;
};

constexpr Index kMaxRankedRefs = 64;  ///< up to this many are ranked by comparing all with all

// Where there is a `step`, one primitive out of so many stands for them.
// merge_refs: merges primitives into bounds of boxes and of centres, both as a PrimitiveRef holds them.
// bin_refs: adds primitives to bins; those whose centres lie outside to the first and the last.
// best_plane: the cheapest plane. Sizes count as full leaf nodes of eight, so that leaf nodes fill up; equal costs are
// decided by the more even sizes. Lengths are multiplied by `measure_scale`; flat boxes are measured by their extents.
// part_ranked_refs: of at most kMaxRankedRefs, brings the `left` ones that are nearest to `origin` along an axis to the
// front. partition_refs: brings those at the left to the front, without a branch, and returns how many they are.
#define SELVAGE_SPLIT_KERNEL                                                                                \
  void merge_refs(const PrimitiveRef* refs, Index count, Index step, float* bounds, float* centres);        \
  void bin_refs(const PrimitiveRef* refs, Index count, Index step, const BinScale& scale, SplitBins& bins); \
  SplitPlane best_plane(const SplitBins& bins, float measure_scale, bool flat);                             \
  void part_ranked_refs(PrimitiveRef* refs, Index count, int axis, float origin, Index left);               \
  Index partition_refs(PrimitiveRef* refs, Index count, const LeftSide& side);
namespace baseline {
SELVAGE_SPLIT_KERNEL
}
namespace avx2 {
SELVAGE_SPLIT_KERNEL
}
namespace avx512 {
SELVAGE_SPLIT_KERNEL
}
#undef SELVAGE_SPLIT_KERNEL

}  // namespace selvage
