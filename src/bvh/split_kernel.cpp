#include "bvh/split_kernel.h"

#include "core/simd/simd.h"

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

constexpr int kBins = SplitBins::kCount;

SELVAGE_INLINE Float8 bounds_of(const PrimitiveRef& ref) {
  return Float8::load(ref.lower);
}

/// (x, y, z, 0) of twice the centre.
SELVAGE_INLINE Float4 centre_of(Float8 bounds) {
  alignas(16) static constexpr std::uint32_t kSpace[4] = {~0u, ~0u, ~0u, 0};
  const Float4 space = Float4::load(reinterpret_cast<const float*>(kSpace));
  return and_bits(bounds.low(), space) - and_bits(bounds.high(), space);
}

SELVAGE_INLINE Float4 extents_of(Float8 bounds) {
  const Float4 zero = Float4::broadcast(0);
  return max(zero - (bounds.low() + bounds.high()), zero);
}

/// The primitive that stands for the i-th `step` of them: at no regular distance, which their order might have, too.
SELVAGE_INLINE Index sampled_place(Index i, Index step) {
  const std::uint32_t random = static_cast<std::uint32_t>(i) * 0x9e3779b9u;
  return i * step + static_cast<Index>(std::uint64_t{random} * static_cast<std::uint32_t>(step) >> 32);
}

/// Primitives on both sides of the planes between bins: bins below i at the left of plane i, the others at the right.
struct Sides {
  float measures[2][3][kBins];
  Index counts[2][3][kBins];
};

SELVAGE_INLINE void sum_counts(const SplitBins& bins, Sides& sides) {
  for (int axis = 0; axis < 3; ++axis) {
    Index left = 0, all = 0;
    for (int i = 0; i < kBins; ++i) all += bins.counts[axis][i];
    for (int i = 0; i < kBins; ++i) {
      sides.counts[0][axis][i] = left;
      sides.counts[1][axis][i] = all - left;
      left += bins.counts[axis][i];
    }
  }
}

/// The measures of four boxes, of which the extents are given.
SELVAGE_INLINE Float4 measure(Float4 a, Float4 b, Float4 c, Float4 d, bool flat) {
  transpose(a, b, c, d);
  return flat ? a + b + c : a * b + b * c + c * a;
}

SELVAGE_INLINE void measure_sides(const SplitBins& bins, float measure_scale, bool flat, Sides& sides) {
  const Float4 scale = Float4::broadcast(measure_scale);
  Float4 extents[2][3][kBins];
  for (int axis = 0; axis < 3; ++axis) {
    const auto bin = [&](int i) { return Float8::load(bins.bounds[axis][i]); };
    Float8 left = bin(0), right = bin(kBins - 1);
    extents[0][axis][0] = Float4::broadcast(0);
    extents[1][axis][0] = Float4::broadcast(0);
    for (int i = 1; i < kBins; ++i) {
      extents[0][axis][i] = extents_of(left) * scale;
      extents[1][axis][kBins - i] = extents_of(right) * scale;
      left = min(left, bin(i));
      right = min(right, bin(kBins - 1 - i));
    }
  }
  for (int side = 0; side < 2; ++side)
    for (int axis = 0; axis < 3; ++axis)
      for (int i = 0; i < kBins; i += 4) {
        const Float4* const four = extents[side][axis] + i;
        measure(four[0], four[1], four[2], four[3], flat).store(sides.measures[side][axis] + i);
      }
}

}  // namespace

void merge_refs(const PrimitiveRef* refs, Index count, Index step, float* bounds, float* centres) {
  Float8 all = Float8::load(bounds), all_centres = Float8::load(centres);
  const Float4 zero = Float4::broadcast(0);
  for (Index i = 0; i < count / step; ++i) {
    const Float8 box = bounds_of(refs[sampled_place(i, step)]);
    const Float4 centre = centre_of(box);
    all = min(all, box);
    all_centres = min(all_centres, Float8::join(centre, zero - centre));
  }
  all.store(bounds);
  all_centres.store(centres);
}

void bin_refs(const PrimitiveRef* refs, Index count, Index step, const BinScale& scale, SplitBins& bins) {
  const Float4 largest = Float4::broadcast(kBins - 1), zero = Float4::broadcast(0), origin = Float4::load(scale.origin);
  const Float4 factor = Float4::load(scale.scale);
  for (Index i = 0; i < count / step; ++i) {
    const Float8 box = bounds_of(refs[sampled_place(i, step)]);
    std::int32_t bin[4];
    min(max((centre_of(box) - origin) * factor, zero), largest).store_int(bin);
    for (int axis = 0; axis < 3; ++axis) {
      float* const merged = bins.bounds[axis][bin[axis]];
      min(Float8::load(merged), box).store(merged);
      ++bins.counts[axis][bin[axis]];
    }
  }
}

SplitPlane best_plane(const SplitBins& bins, float measure_scale, bool flat) {
  Sides sides;
  sum_counts(bins, sides);
  measure_sides(bins, measure_scale, flat, sides);
  const auto leaf_nodes = [](Index count) {
    const Index nodes = (count + 7) / 8;
    return static_cast<float>(nodes);
  };
  float costs[3][kBins];
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kBins; ++i) {
      const Index left = sides.counts[0][axis][i], right = sides.counts[1][axis][i];
      const float cost = sides.measures[0][axis][i] * leaf_nodes(left) + sides.measures[1][axis][i] * leaf_nodes(right);
      costs[axis][i] = ((left > 0) & (right > 0)) ? cost : __builtin_inff();  // without a branch
    }
  float lowest = __builtin_inff();
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kBins; ++i) lowest = costs[axis][i] < lowest ? costs[axis][i] : lowest;
  SplitPlane best;
  if (!(lowest < __builtin_inff())) return best;
  Index best_excess = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 1; i < kBins; ++i) {
      if (costs[axis][i] != lowest) continue;
      const Index excess = __builtin_abs(sides.counts[0][axis][i] - sides.counts[1][axis][i]);
      if (best.axis >= 0 && excess >= best_excess) continue;
      best.axis = axis;
      best.first_right_bin = i;
      best_excess = excess;
    }
  return best;
}

void part_ranked_refs(PrimitiveRef* refs, Index count, int axis, float origin, Index left) {
  // Distances as integers, which compare like floats where these are not negative, with the place in the last bits.
  std::int32_t keys[kMaxRankedRefs], ranks[kMaxRankedRefs] = {};
  for (Index i = 0; i < kMaxRankedRefs; ++i) keys[i] = 0x7fffffff;
  for (Index i = 0; i < count; ++i) {
    const float distance = refs[i].lower[axis] - refs[i].negated_upper[axis] - origin;
    const auto bits = __builtin_bit_cast(std::int32_t, distance > 0 ? distance : 0.0f);
    keys[i] = (bits & ~(kMaxRankedRefs - 1)) | i;
  }
  const Index padded = (count + 15) & ~15;
  for (Index i = 0; i < count; ++i)
    for (Index k = 0; k < padded; ++k) ranks[k] += keys[i] < keys[k];
  Index front = 0;
  for (Index i = 0; i < count; ++i) {
    const Float8 ref = bounds_of(refs[i]);
    bounds_of(refs[front]).store(refs[i].lower);
    ref.store(refs[front].lower);
    front += ranks[i] < left;
  }
}

Index partition_refs(PrimitiveRef* refs, Index count, const LeftSide& side) {
  Index left = 0;
  for (Index i = 0; i < count; ++i) {
    // Each changes places with the first one at the right, which then may end at the left.
    const Float8 ref = bounds_of(refs[i]);
    const float place = (refs[i].lower[side.axis] - refs[i].negated_upper[side.axis] - side.origin) * side.scale;
    bounds_of(refs[left]).store(refs[i].lower);
    ref.store(refs[left].lower);
    left += place < side.first_right_bin;
  }
  return left;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
