#include "simulation/elements/measure_kernel.h"

#include "simulation/elements/wide_axes.h"

#include <algorithm>
#include <cmath>

namespace selvage {
inline namespace SELVAGE_ISA {

namespace {

/// Edges of elements from their first vertices.
struct Edges {
  Wide3 at[3];

  SELVAGE_INLINE Edges(const double* rows, const Index (&offsets)[4][kMeasureBatch], int lane) {
    const auto load_point = [&](int k) {
      WideDouble columns[4];
      load_rows(rows, offsets[k] + lane, columns);
      return Wide3{{columns[0], columns[1], columns[2]}};
    };
    const Wide3 origin = load_point(0);
    for (int k = 0; k < 3; ++k) at[k] = load_point(k + 1) - origin;
  }
};

}  // namespace

void measure_from_rest(const MeasureTask& task, std::int64_t first, std::int64_t last, BatchMeasure* sums) {
  const WideDouble half = wide_number(0.5), one = wide_number(1), three = wide_number(3), mu = wide_number(task.mu),
                   bulk = wide_number(task.bulk);
  for (std::int64_t n = first; n < last; ++n) {
    const auto places = static_cast<int>(std::min<std::int64_t>(task.count - n * kMeasureBatch, kMeasureBatch));
    Index offsets[4][kMeasureBatch];
    for (int i = 0; i < kMeasureBatch; ++i)
      for (int k = 0; k < 4; ++k) offsets[k][i] = 4 * task.elements[n * kMeasureBatch + (i < places ? i : 0)][k];
    double energies[kMeasureBatch], volumes[kMeasureBatch], rest_volumes[kMeasureBatch];
    for (int lane = 0; lane < kMeasureBatch; lane += WideDouble::kLanes) {
      const Edges rest(task.rest_rows, offsets, lane), now(task.rows, offsets, lane);
      const Wide3 faces[3] = {cross(rest.at[1], rest.at[2]), cross(rest.at[2], rest.at[0]),
                              cross(rest.at[0], rest.at[1])};
      const WideDouble rest_volume = dot(rest.at[0], faces[0]), volume = dot(now.at[0], cross(now.at[1], now.at[2]));
      // F is the sum of now.at[k] faces[k]^T over the volume at rest.
      WideDouble square = wide_number(0);
      for (int j = 0; j < 3; ++j) {
        const Wide3 column = faces[0][j] * now.at[0] + faces[1][j] * now.at[1] + faces[2][j] * now.at[2];
        square = square + dot(column, column);
      }
      square = square / (rest_volume * rest_volume);
      const WideDouble growth = volume / rest_volume - one;
      const WideDouble density = half * mu * (square - three) - mu * growth + half * bulk * growth * growth;
      (density * rest_volume).store(energies + lane);
      volume.store(volumes + lane);
      rest_volume.store(rest_volumes + lane);
    }
    BatchMeasure sum{};
    for (int i = 0; i < places; ++i) {
      sum.energy += energies[i] / 6;
      sum.volume += volumes[i] / 6;
      sum.rest_volume += rest_volumes[i] / 6;
      sum.flat_elements += std::abs(volumes[i]) <= kFlatVolume * rest_volumes[i];
    }
    sums[n] = sum;
  }
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
