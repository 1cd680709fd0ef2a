#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Elements that measure_from_rest() takes side by side, whatever the width of registers.
inline constexpr int kMeasureBatch = 8;

struct MeasureTask {
  const double *rows, *rest_rows;  ///< (4 x n_vertices) positions, each followed by one number that means nothing
  const VertexTuple<4>* elements;  ///< consecutive ones of a body
  std::int64_t count;
  double mu, bulk;  ///< NeoHookean, lambda + mu [Pa]
};

/// Sums over the elements of a batch.
struct BatchMeasure {
  double energy, volume, rest_volume;  ///< [J], [m^3]; volumes of inverted elements below 0
  std::int64_t flat_elements;          ///< with a volume of at most kFlatVolume of that at rest, inverted or not
};

inline constexpr double kFlatVolume = 1e-9;

// Of the batches [first, last).
#define SELVAGE_MEASURE_KERNEL \
  void measure_from_rest(const MeasureTask&, std::int64_t first, std::int64_t last, BatchMeasure* sums);
namespace baseline {
SELVAGE_MEASURE_KERNEL
}
namespace avx2 {
SELVAGE_MEASURE_KERNEL
}
namespace avx512 {
SELVAGE_MEASURE_KERNEL
}
#undef SELVAGE_MEASURE_KERNEL

}  // namespace selvage
