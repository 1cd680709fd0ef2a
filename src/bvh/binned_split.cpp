#include "bvh/binned_split.h"

#include "core/parallel.h"

#include <algorithm>
#include <limits>

namespace selvage {

namespace {

constexpr Index kParallelSize = 1 << 17;  ///< ranges larger than this are split in parallel
constexpr Index kChunk = 1 << 13;
constexpr Index kSampled = 1 << 10;     ///< primitives of a larger range that tell where to split it: as good as all
constexpr Index kSampledFast = 1 << 6;  ///< nearly as good
constexpr float kHuge = std::numeric_limits<float>::max() / 8;  ///< sums and differences of a few stay finite

float clamp(float x) {
  return x > -kHuge ? (x < kHuge ? x : kHuge) : -kHuge;
}

Float8 nothing() {
  return Float8::broadcast(kHuge);
}

Float4 extents_of(Float8 bounds) {
  const Float4 zero = Float4::broadcast(0);
  return max(zero - (bounds.low() + bounds.high()), zero);
}

/// Bounds of primitives and of their centres.
struct BoundsPair {
  alignas(32) float bounds[8];
  alignas(32) float centres[8];

  BoundsPair() {
    nothing().store(bounds);
    nothing().store(centres);
  }
  void add(const BoundsPair& other) {
    min(Float8::load(bounds), Float8::load(other.bounds)).store(bounds);
    min(Float8::load(centres), Float8::load(other.centres)).store(centres);
  }
};

struct EmptyBins : SplitBins {
  EmptyBins() {
    for (auto& axis : bounds)
      for (auto& bin : axis) nothing().store(bin);
    for (auto& axis : counts) std::fill(std::begin(axis), std::end(axis), 0);
  }
};

PrimitiveRef make_ref(const Box& box, Index primitive) {
  PrimitiveRef ref;
  ref.primitive = primitive;
  ref.unused = 0;
  for (int axis = 0; axis < 3; ++axis) {
    ref.lower[axis] = clamp(box.lower[axis]);
    ref.negated_upper[axis] = clamp(-box.upper[axis]);
  }
  return ref;
}

/// The factor of lengths where boxes inside `whole` are measured, so that nothing overflows or vanishes.
float measure_scale(Float8 whole) {
  float extents[4];
  extents_of(whole).store(extents);
  return 1 / std::max(std::max({extents[0], extents[1], extents[2]}), std::numeric_limits<float>::min());
}

}  // namespace

RangeSplitter::RangeSplitter(std::span<const Box> boxes, BuildQuality quality)
    : quality_(quality), refs_(std::make_unique_for_overwrite<PrimitiveRef[]>(boxes.size())) {
  const Index count = static_cast<Index>(boxes.size());
  if (count > kParallelSize) scratch_ = std::make_unique_for_overwrite<PrimitiveRef[]>(boxes.size());
  // Few are made by the thread that splits them first: it would wait longer for those of other cores.
  const Index chunk = count > kParallelSize ? kChunk : std::max<Index>(count, 1);
  parallel_for(count, chunk, [&](std::int64_t i) { refs_[i] = make_ref(boxes[i], static_cast<Index>(i)); });
  const BoundsPair all =
      parallel_reduce<BoundsPair>(count, chunk, [&](std::int64_t i, std::int64_t end, BoundsPair& r) {
        SELVAGE_DISPATCH(merge_refs, refs_.get() + i, static_cast<Index>(end - i), 1, r.bounds, r.centres);
      });
  float extents[4];
  extents_of(Float8::load(all.bounds)).store(extents);
  flat_ = std::min({extents[0], extents[1], extents[2]}) == 0;
  largest_extent_ = std::max({extents[0], extents[1], extents[2]});
}

/// One primitive out of so many tells where to split a range.
Index RangeSplitter::sampling_step(Index count) const {
  return std::max(1, count / (quality_ == BuildQuality::kFast ? kSampledFast : kSampled));
}

RefRange RangeSplitter::make_range(Index begin, Index end) const {
  BoundsPair pair;
  SELVAGE_DISPATCH(merge_refs, refs_.get() + begin, end - begin, sampling_step(end - begin), pair.bounds, pair.centres);
  return {begin, end, Float8::load(pair.bounds), Float8::load(pair.centres)};
}

RefRange RangeSplitter::make_part(Index begin, Index end) const {
  return end - begin > BvhNode::kWidth ? make_range(begin, end) : RefRange{begin, end, nothing(), nothing()};
}

float RangeSplitter::measure(Float8 bounds, Float8 whole) const {
  float e[4];
  (extents_of(bounds) * Float4::broadcast(measure_scale(whole))).store(e);
  return flat_ ? e[0] + e[1] + e[2] : e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

std::array<RefRange, 2> RangeSplitter::split(const RefRange& range, bool halve) {
  if (quality_ == BuildQuality::kFast && range.size() <= kMaxRankedRefs) {
    const Index middle = halve_ranked(range);
    return {make_part(range.begin, middle), make_part(middle, range.end)};
  }
  BinScale scale{};
  float extents[4];
  range.centres.low().store(scale.origin);
  extents_of(range.centres).store(extents);
  // A wider extent than this has a finite reciprocal, and its two ends fall into different bins.
  constexpr float kSmallest = std::numeric_limits<float>::min() * (1 << 10);
  for (int axis = 0; axis < 3; ++axis)
    if (extents[axis] > kSmallest) scale.scale[axis] = SplitBins::kCount / extents[axis];
  SplitPlane plane;
  if (!halve) {
    EmptyBins bins;
    SELVAGE_DISPATCH(bin_refs, refs_.get() + range.begin, range.size(), sampling_step(range.size()), scale, bins);
    plane = SELVAGE_DISPATCH(best_plane, bins, measure_scale(range.bounds), flat_);
  }
  const auto [axis, first_right_bin] = plane;
  const Index middle =
      axis < 0 ? halve_range(range)
               : partition(range, {axis, scale.origin[axis], scale.scale[axis], static_cast<float>(first_right_bin)});
  return {make_part(range.begin, middle), make_part(middle, range.end)};
}

Index RangeSplitter::partition(const RefRange& range, const LeftSide& side) {
  if (range.size() > kParallelSize) return partition_parallel(range.begin, range.end, side);
  return range.begin + SELVAGE_DISPATCH(partition_refs, refs_.get() + range.begin, range.size(), side);
}

/// Stable, through the scratch array: each chunk counts its share, then moves it to its place.
Index RangeSplitter::partition_parallel(Index begin, Index end, const LeftSide& side) {
  const Index chunks = (end - begin + kChunk - 1) / kChunk;
  const auto chunk_end = [&](Index chunk) { return std::min(begin + (chunk + 1) * kChunk, end); };
  std::vector<Index> left_start(chunks + 1, 0);
  parallel_for(chunks, 1, [&](std::int64_t c) {
    const Index chunk = static_cast<Index>(c);
    Index count = 0;
    for (Index i = begin + chunk * kChunk; i < chunk_end(chunk); ++i) count += side.holds(refs_[i]);
    left_start[chunk + 1] = count;
  });
  for (Index chunk = 0; chunk < chunks; ++chunk) left_start[chunk + 1] += left_start[chunk];
  const Index middle = begin + left_start[chunks];
  parallel_for(chunks, 1, [&](std::int64_t c) {
    const Index chunk = static_cast<Index>(c);
    Index to_left = begin + left_start[chunk], to_right = middle + chunk * kChunk - left_start[chunk];
    for (Index i = begin + chunk * kChunk; i < chunk_end(chunk); ++i)
      scratch_[side.holds(refs_[i]) ? to_left++ : to_right++] = refs_[i];
  });
  parallel_ranges(end - begin, kChunk, [&](std::int64_t first, std::int64_t last) {
    std::copy(scratch_.get() + begin + first, scratch_.get() + begin + last, refs_.get() + begin + first);
  });
  return middle;
}

/// Of more than eight primitives, along the widest axis; at a multiple of eight, so that leaf nodes are full.
Index RangeSplitter::halve_ranked(const RefRange& range) {
  float extents[4], origin[4];
  extents_of(range.centres).store(extents);
  range.centres.low().store(origin);
  const int axis = static_cast<int>(std::max_element(extents, extents + 3) - extents);
  const Index left = (range.size() + BvhNode::kWidth) / (2 * BvhNode::kWidth) * BvhNode::kWidth;
  SELVAGE_DISPATCH(part_ranked_refs, refs_.get() + range.begin, range.size(), axis, origin[axis], left);
  return range.begin + left;
}

Index RangeSplitter::halve_range(const RefRange& range) {
  float extents[4];
  extents_of(range.centres).store(extents);
  const int axis = static_cast<int>(std::max_element(extents, extents + 3) - extents);
  const Index middle = range.begin + range.size() / 2;
  std::nth_element(refs_.get() + range.begin, refs_.get() + middle, refs_.get() + range.end,
                   [axis](const PrimitiveRef& a, const PrimitiveRef& b) {
                     const float x = a.centre(axis), y = b.centre(axis);
                     return x < y || (x == y && a.primitive < b.primitive);
                   });
  return middle;
}

}  // namespace selvage
