#pragma once

#include "core/simd/simd.h"
#include "selvage/core/types.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// Up to eight pairs that are tested together.
struct EightPairs {
  static constexpr int kSize = 8;
  Index first[kSize];
  Index second[kSize];
  int count = 0;

  /// Returns whether it is full.
  SELVAGE_INLINE bool add(Index a, Index b) {
    first[count] = a;
    second[count] = b;
    return ++count == kSize;
  }

  /// Repeats the first pair in the empty places. Returns the mask of the pairs.
  SELVAGE_INLINE unsigned fill() {
    for (int i = count; i < kSize; ++i) {
      first[i] = first[0];
      second[i] = second[0];
    }
    return (1u << count) - 1;
  }
};

}  // namespace SELVAGE_ISA
}  // namespace selvage
