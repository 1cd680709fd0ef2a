#pragma once

#include "core/parallel.h"
#include "selvage/core/types.h"

namespace selvage {

/// Positions as kernels take them: each followed by a 0.
inline std::vector<double> rows_of(std::span<const Vec3> x) {
  constexpr int kRow = 4;
  std::vector<double> rows(kRow * x.size());
  parallel_for(std::ssize(x), kGrain, [&](std::int64_t v) {
    for (int i = 0; i < 3; ++i) rows[kRow * v + i] = x[v][i];
  });
  return rows;
}

}  // namespace selvage
