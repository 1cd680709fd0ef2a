#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"

namespace selvage {

/// Elements of one vertex side by side, whatever the width of registers.
inline constexpr int kStarBatch = 8;
/// Numbers of a vertex in StarTask::rows.
inline constexpr int kStarRow = 4;

/// Elements of one vertex p, each by its other three vertices q, so ordered that det(q0 - p, q1 - p, q2 - p) is
/// positive at rest. A place without one has p for all q, and zeros: it adds nothing.
struct alignas(64) StarBatch {
  Index rows[3][kStarBatch];      ///< kStarRow times the vertices q
  double weights[3][kStarBatch];  ///< the stress mu F pulls p with the sum of weights * (q - p) [N/m], downhill
  double inverse_determinant[kStarBatch];  ///< 1 / (6 rest volume) [1/m^3]
  double bulk[kStarBatch];                 ///< (lambda + mu) times the rest volume [J]
  double shear[kStarBatch];                ///< mu times the rest volume [J]
};

/// Sums over elements of a vertex, by its position.
struct StarSums {
  double gradient[3];
  double hessian[6];  ///< by 00 11 22 01 02 12, without the part that is the same in all poses
};

/// Stars of vertices in a row.
struct StarTask {
  const double* rows;     ///< (kStarRow x n_vertices) positions, each followed by one number that means nothing
  const Index* own_rows;  ///< of each star: that of its vertex
  const StarBatch* batches;
  const std::int64_t* first_batches;  ///< (n_stars + 1)
};

// Sums of the stars [first, last).
#define SELVAGE_STAR_KERNEL void sum_stars(const StarTask&, Index first, Index last, StarSums* sums);
namespace baseline {
SELVAGE_STAR_KERNEL
}
namespace avx2 {
SELVAGE_STAR_KERNEL
}
namespace avx512 {
SELVAGE_STAR_KERNEL
}
#undef SELVAGE_STAR_KERNEL

}  // namespace selvage
