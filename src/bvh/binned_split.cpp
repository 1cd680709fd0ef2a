#include "bvh/binned_split.h"

#include "selvage/core/parallel.h"

#include <algorithm>
#include <limits>

namespace selvage {

namespace {

constexpr int kBins = 16;
constexpr Index kParallelSize = 1 << 15;  ///< ranges larger than this are split in parallel
constexpr Index kChunk = 1 << 13;
constexpr float kHuge = std::numeric_limits<float>::max() / 8;  ///< sums and differences of a few stay finite

float clamp(float x) {
  return x > -kHuge ? (x < kHuge ? x : kHuge) : -kHuge;
}

Float8 nothing() {
  return Float8::broadcast(kHuge);
}

/// (x, y, z, 0) of twice the centre.
Float4 centre_of(Float8 bounds) {
  alignas(16) static constexpr std::uint32_t kSpace[4] = {~0u, ~0u, ~0u, 0};
  const Float4 space = Float4::load(reinterpret_cast<const float*>(kSpace));
  return and_bits(bounds.low(), space) - and_bits(bounds.high(), space);
}

Float4 extents_of(Float8 bounds) {
  const Float4 zero = Float4::broadcast(0);
  return max(zero - (bounds.low() + bounds.high()), zero);
}

struct BoundsPair {
  Float8 bounds = nothing();
  Float8 centres = nothing();

  void add(Float8 ref) {
    const Float4 centre = centre_of(ref);
    bounds = min(bounds, ref);
    centres = min(centres, Float8::join(centre, Float4::broadcast(0) - centre));
  }
  void add(const BoundsPair& other) {
    bounds = min(bounds, other.bounds);
    centres = min(centres, other.centres);
  }
};

/// Sums `add_piece(first, last, result)` over pieces of [begin, end): minima and counts, so any pieces give the same.
template <typename Result, typename AddPiece>
Result reduce_range(Index begin, Index end, AddPiece&& add_piece) {
  if (end - begin <= kParallelSize) {
    Result result;
    add_piece(begin, end, result);
    return result;
  }
  return parallel_reduce<Result>(end - begin, kChunk, [&](std::int64_t first, std::int64_t last, Result& result) {
    add_piece(static_cast<Index>(begin + first), static_cast<Index>(begin + last), result);
  });
}

/// Bounds and counts of the primitives in each bin of each axis.
struct Bins {
  std::array<Float8, 3 * kBins> bounds;
  std::array<Index, 3 * kBins> counts{};

  Bins() { bounds.fill(nothing()); }

  void add_refs(const PrimitiveRef* first, const PrimitiveRef* last, Float4 origin, Float4 scale) {
    const Float4 largest = Float4::broadcast(kBins - 1);
    for (const PrimitiveRef* ref = first; ref != last; ++ref) {
      const Float8 box = ref->bounds();
      std::int32_t bin[4];
      min((centre_of(box) - origin) * scale, largest).store_int(bin);
      for (int axis = 0; axis < 3; ++axis) {
        const int i = axis * kBins + bin[axis];
        bounds[i] = min(bounds[i], box);
        ++counts[i];
      }
    }
  }
  void add(const Bins& other) {
    for (int i = 0; i < 3 * kBins; ++i) {
      bounds[i] = min(bounds[i], other.bounds[i]);
      counts[i] += other.counts[i];
    }
  }
};

/// The measure of boxes inside `whole`.
class RelativeMeasure {
 public:
  RelativeMeasure(Float8 whole, bool flat) : flat_(flat) {
    float extents[4];
    extents_of(whole).store(extents);
    const float largest = std::max({extents[0], extents[1], extents[2]});
    scale_ = Float4::broadcast(1 / std::max(largest, std::numeric_limits<float>::min()));
  }
  float operator()(Float8 bounds) const {
    float e[4];
    (extents_of(bounds) * scale_).store(e);
    return flat_ ? e[0] + e[1] + e[2] : e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
  }

 private:
  Float4 scale_;
  bool flat_;
};

/// A plane between two bins: primitives in bins below `first_right_bin` go left. Axis -1: none parts the primitives.
struct SplitPlane {
  int axis = -1;
  int first_right_bin = 0;
};

/// The cheapest plane. Sizes count as full leaf nodes of eight, so that leaf nodes fill up; equal costs are decided by
/// the more even sizes.
SplitPlane best_plane(const Bins& bins, const RelativeMeasure& measure) {
  const auto leaf_nodes = [](Index n) { return static_cast<float>((n + BvhNode::kWidth - 1) / BvhNode::kWidth); };
  SplitPlane best;
  float best_cost = std::numeric_limits<float>::infinity();
  Index best_excess = std::numeric_limits<Index>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const Float8* const bounds = &bins.bounds[axis * kBins];
    const Index* const counts = &bins.counts[axis * kBins];
    float right_cost[kBins];
    Index right_count[kBins];
    Float8 merged = nothing();
    Index count = 0;
    for (int i = kBins - 1; i > 0; --i) {
      merged = min(merged, bounds[i]);
      count += counts[i];
      right_count[i] = count;
      right_cost[i] = measure(merged) * leaf_nodes(count);
    }
    merged = nothing();
    count = 0;
    for (int i = 1; i < kBins; ++i) {
      merged = min(merged, bounds[i - 1]);
      count += counts[i - 1];
      if (count == 0 || right_count[i] == 0) continue;
      const float cost = measure(merged) * leaf_nodes(count) + right_cost[i];
      const Index excess = std::abs(count - right_count[i]);
      if (cost < best_cost || (cost == best_cost && excess < best_excess)) {
        best = {axis, i};
        best_cost = cost;
        best_excess = excess;
      }
    }
  }
  return best;
}

}  // namespace

PrimitiveRef::PrimitiveRef(const Box& box, Index which) : primitive(which), unused(0) {
  for (int axis = 0; axis < 3; ++axis) {
    lower[axis] = clamp(box.lower[axis]);
    negated_upper[axis] = clamp(-box.upper[axis]);
  }
}

RangeSplitter::RangeSplitter(std::span<const Box> boxes)
    : refs_(std::make_unique_for_overwrite<PrimitiveRef[]>(boxes.size())) {
  const Index count = static_cast<Index>(boxes.size());
  if (count > kParallelSize) scratch_ = std::make_unique_for_overwrite<PrimitiveRef[]>(boxes.size());
  parallel_for(count, kChunk, [&](std::int64_t i) { refs_[i] = PrimitiveRef(boxes[i], static_cast<Index>(i)); });
  float extents[4];
  extents_of(make_range(0, count).bounds).store(extents);
  flat_ = std::min({extents[0], extents[1], extents[2]}) == 0;
  largest_extent_ = std::max({extents[0], extents[1], extents[2]});
}

RefRange RangeSplitter::make_range(Index begin, Index end) const {
  const BoundsPair pair = reduce_range<BoundsPair>(begin, end, [&](Index first, Index last, BoundsPair& result) {
    for (Index i = first; i < last; ++i) result.add(refs_[i].bounds());
  });
  return {begin, end, pair.bounds, pair.centres};
}

float RangeSplitter::measure(Float8 bounds, Float8 whole) const {
  return RelativeMeasure(whole, flat_)(bounds);
}

std::array<RefRange, 2> RangeSplitter::split(const RefRange& range, bool halve) {
  float origin[4], extents[4], scale[4] = {};
  range.centres.low().store(origin);
  extents_of(range.centres).store(extents);
  // A wider extent than this has a finite reciprocal, and its two ends fall into different bins.
  constexpr float kSmallest = std::numeric_limits<float>::min() * (1 << 10);
  for (int axis = 0; axis < 3; ++axis)
    if (extents[axis] > kSmallest) scale[axis] = kBins / extents[axis];
  SplitPlane plane;
  if (!halve) {
    const Bins bins = reduce_range<Bins>(range.begin, range.end, [&](Index first, Index last, Bins& result) {
      result.add_refs(refs_.get() + first, refs_.get() + last, Float4::load(origin), Float4::load(scale));
    });
    plane = best_plane(bins, RelativeMeasure(range.bounds, flat_));
  }
  const auto [axis, first_right_bin] = plane;
  const Index middle = axis < 0
                           ? halve_range(range)
                           : partition(range, {axis, origin[axis], scale[axis], static_cast<float>(first_right_bin)});
  return {make_range(range.begin, middle), make_range(middle, range.end)};
}

Index RangeSplitter::partition(const RefRange& range, const LeftSide& side) {
  if (range.size() > kParallelSize) return partition_parallel(range.begin, range.end, side);
  // Without a branch: each primitive changes places with the first one at the right, which then may end at the left.
  Index left = range.begin;
  for (Index i = range.begin; i < range.end; ++i) {
    const PrimitiveRef ref = refs_[i];
    refs_[i] = refs_[left];
    refs_[left] = ref;
    left += side.holds(ref);
  }
  return left;
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
