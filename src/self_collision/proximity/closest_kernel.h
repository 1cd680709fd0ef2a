#pragma once

#include "core/isa.h"

namespace selvage {

/// Pairs of segments, a and b, side by side.
struct SegmentPairs {
  static constexpr int kSize = 8;

  alignas(64) double a[2][3][kSize];  ///< ends, coordinates
  alignas(64) double b[2][3][kSize];
  alignas(64) double place[2][kSize];  ///< of the closest points, as ClosestSegmentPoints has them
  alignas(64) double squared_distance[kSize];
  /// Of the squares on the way: where these might over- or underflow, nothing above is of use.
  alignas(64) double least[kSize], most[kSize];
};

// Finds the places of the closest points, and their squared distance: the same bits as closest_points() has.
#define SELVAGE_CLOSEST_KERNEL void find_closest_places(SegmentPairs&);
namespace baseline {
SELVAGE_CLOSEST_KERNEL
}
namespace avx2 {
SELVAGE_CLOSEST_KERNEL
}
namespace avx512 {
SELVAGE_CLOSEST_KERNEL
}
#undef SELVAGE_CLOSEST_KERNEL

}  // namespace selvage
