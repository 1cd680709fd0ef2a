#pragma once

#include "bvh/bvh.h"
#include "bvh/split_kernel.h"
#include "core/simd/simd.h"

#include <memory>

namespace selvage {

/// Consecutive primitives, with the bounds of their boxes and of their centres (both as a PrimitiveRef holds them), in
/// large ranges of a sample.
struct RefRange {
  Index begin;
  Index end;
  Float8 bounds;
  Float8 centres;

  Index size() const { return end - begin; }
};

/// Splits ranges of primitives in two, so that the expected cost of a query is small (surface-area heuristic over 16
/// bins of centres on each axis, in large ranges of a sample of primitives); where building counts most, small ranges
/// in the middle. Large ranges are split in parallel; the result is the same for any number of threads.
class RangeSplitter {
 public:
  RangeSplitter(std::span<const Box> boxes, BuildQuality quality);

  RefRange make_range(Index begin, Index end) const;

  /// Surface measure of a box, relative to the largest extent of `whole`, so that it neither overflows nor vanishes.
  float measure(Float8 bounds, Float8 whole) const;

  /// Splits a range of at least two primitives where the measured cost is smallest; in halves, by centre along the
  /// widest axis, when `halve` asks for it or the centres are too close to be separated. A range that fits into a
  /// leaf node comes without bounds.
  std::array<RefRange, 2> split(const RefRange& range, bool halve);

  Index primitive(Index position) const { return refs_[position].primitive; }
  bool flat() const { return flat_; }
  float largest_extent() const { return largest_extent_; }
  /// Frees memory: nothing is split afterwards.
  void free_scratch() { scratch_.reset(); }

 private:
  Index partition(const RefRange& range, const LeftSide& side);
  Index partition_parallel(Index begin, Index end, const LeftSide& side);
  Index halve_range(const RefRange& range);
  Index halve_ranked(const RefRange& range);
  Index sampling_step(Index count) const;
  RefRange make_part(Index begin, Index end) const;

  BuildQuality quality_;
  std::unique_ptr<PrimitiveRef[]> refs_;
  std::unique_ptr<PrimitiveRef[]> scratch_;
  bool flat_ = false;
  float largest_extent_ = 0;
};

}  // namespace selvage
