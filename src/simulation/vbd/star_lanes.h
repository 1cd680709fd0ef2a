#pragma once

#include "core/simd/simd_double.h"
#include "core/simd/vec3.h"
#include "simulation/vbd/star_kernel.h"

/// What the kernels of stars share.
namespace selvage {
inline namespace SELVAGE_ISA {

using Wide3 = LaneVec3<WideDouble>;

SELVAGE_INLINE Wide3 broadcast_point(const double* p) {
  return {{WideDouble::broadcast(p[0]), WideDouble::broadcast(p[1]), WideDouble::broadcast(p[2])}};
}

SELVAGE_INLINE Wide3 load_points(const double* rows, const Index* offsets) {
  WideDouble columns[4];
  load_rows(rows, offsets, columns);
  return {{columns[0], columns[1], columns[2]}};
}

SELVAGE_INLINE double sum_of(const double (&x)[kStarBatch]) {
  return ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7]));
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
