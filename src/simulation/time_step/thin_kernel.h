#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"

namespace selvage {

/// Elements side by side, whatever the width of registers.
inline constexpr int kThinBatch = 8;

/// Consecutive elements. A place without one has -infinity as the least of volumes.
struct ThinBatch {
  Index rows[4][kThinBatch];  ///< four times the vertices
  double least[kThinBatch];   ///< six times the volume below which one is thin [m^3]
};

// Whether an element of each of the batches [first, last) is thin.
// rows: (4 x n_vertices) positions, each followed by one number that means nothing
#define SELVAGE_THIN_KERNEL                                                                           \
  void find_thin_batches(const double* rows, const ThinBatch*, std::int64_t first, std::int64_t last, \
                         unsigned char* is_thin);
namespace baseline {
SELVAGE_THIN_KERNEL
}
namespace avx2 {
SELVAGE_THIN_KERNEL
}
namespace avx512 {
SELVAGE_THIN_KERNEL
}
#undef SELVAGE_THIN_KERNEL

}  // namespace selvage
