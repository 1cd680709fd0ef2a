#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>

namespace selvage {

/// Calls `body(first, last)` on consecutive pieces of [0, count) of at most about `grain` items, on all cores that the
/// caller's oneTBB arena or global_control allows. The pieces are disjoint; their order and number are unspecified, so
/// a body must write only what belongs to its own items.
template <typename Body>
void parallel_ranges(std::int64_t count, std::int64_t grain, Body&& body) {
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, grain),
                    [&](const tbb::blocked_range<std::int64_t>& range) { body(range.begin(), range.end()); });
}

/// Calls `body(i)` for every i in [0, count), in parallel.
template <typename Body>
void parallel_for(std::int64_t count, std::int64_t grain, Body&& body) {
  parallel_ranges(count, grain, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i) body(i);
  });
}

}  // namespace selvage
