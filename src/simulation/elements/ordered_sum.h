#pragma once

#include "core/parallel.h"

#include <cmath>
#include <vector>

namespace selvage {

/// Sum of value(i) over [0, count), in parallel, with the same bits for any number of threads: in runs of fixed length,
/// whose sums are added in their order.
template <typename Value>
double ordered_sum(std::int64_t count, const Value& value) {
  constexpr std::int64_t kRun = 256;
  std::vector<double> sums((count + kRun - 1) / kRun);
  parallel_for(std::ssize(sums), 4, [&](std::int64_t run) {
    double sum = 0;
    for (std::int64_t i = run * kRun; i < std::min((run + 1) * kRun, count); ++i) sum += value(i);
    sums[run] = sum;
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

}  // namespace selvage
