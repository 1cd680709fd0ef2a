#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <future>
#include <mutex>
#include <vector>

namespace selvage {

/// Items of one task, where an item is a vertex, a face or an element and takes some tens of nanoseconds.
inline constexpr std::int64_t kGrain = 4096;

namespace detail {

/// True in builds for the thread sanitizer. Debian's oneTBB is built without it, so that the sanitizer sees no order
/// between tasks and reports races that are none; plain threads stand in there, and races of our own code are found.
#ifdef __SANITIZE_THREAD__
inline constexpr bool kPlainThreads = true;
#else
inline constexpr bool kPlainThreads = false;
#endif

/// Pieces of [0, count) on four plain threads; no piece is ordered before another.
template <typename Body>
void ranges_on_plain_threads(std::int64_t count, std::int64_t grain, Body& body) {
  std::atomic<std::int64_t> next = 0;
  const auto work = [&] {
    for (;;) {
      const std::int64_t first = next.fetch_add(grain, std::memory_order_relaxed);
      if (first >= count) return;
      body(first, std::min(first + grain, count));
    }
  };
  std::array<std::future<void>, 3> others;
  if (count > grain)
    for (auto& other : others) other = std::async(std::launch::async, work);
  work();
  for (auto& other : others)
    if (other.valid()) other.get();
}

}  // namespace detail

/// Calls `body(first, last)` on consecutive pieces of [0, count) of at most about `grain` items, on all cores that the
/// caller's oneTBB arena or global_control allows. The pieces are disjoint; their order and number are unspecified, so
/// a body must write only what belongs to its own items.
template <typename Body>
void parallel_ranges(std::int64_t count, std::int64_t grain, Body&& body) {
  if constexpr (detail::kPlainThreads) {
    detail::ranges_on_plain_threads(count, grain, body);
  } else {
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::int64_t>& range) { body(range.begin(), range.end()); });
  }
}

/// Calls `body(i)` for every i in [0, count), in parallel.
template <typename Body>
void parallel_for(std::int64_t count, std::int64_t grain, Body&& body) {
  parallel_ranges(count, grain, [&](std::int64_t first, std::int64_t last) {
    for (std::int64_t i = first; i < last; ++i) body(i);
  });
}

/// Sum of `add_piece(first, last, result)` over pieces of [0, count), each into a fresh `Result()` that is then taken
/// in by `result.add(other)`. The pieces are unspecified, so that `add` must not depend on them: minima and counts,
/// never sums of floating-point numbers.
template <typename Result, typename AddPiece>
Result parallel_reduce(std::int64_t count, std::int64_t grain, AddPiece&& add_piece) {
  if constexpr (detail::kPlainThreads) {
    Result total;
    std::mutex adding;
    parallel_ranges(count, grain, [&](std::int64_t first, std::int64_t last) {
      Result result;
      add_piece(first, last, result);
      const std::lock_guard guard(adding);
      total.add(result);
    });
    return total;
  } else {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::int64_t>(0, count, grain), Result(),
        [&](const tbb::blocked_range<std::int64_t>& range, const Result& before) {
          Result result = before;
          add_piece(range.begin(), range.end(), result);
          return result;
        },
        [](const Result& left, const Result& right) {
          Result result = left;
          result.add(right);
          return result;
        });
  }
}

/// The numbers in [0, count) for which `predicate(i)` holds, ascending; in parallel. For few: each is listed under a
/// lock.
template <typename Predicate>
std::vector<std::int64_t> parallel_list_if(std::int64_t count, std::int64_t grain, Predicate&& predicate) {
  std::vector<std::int64_t> found;
  std::mutex listing;
  parallel_for(count, grain, [&](std::int64_t i) {
    if (!predicate(i)) return;
    const std::lock_guard lock(listing);
    found.push_back(i);
  });
  std::sort(found.begin(), found.end());
  return found;
}

/// Calls both, in parallel.
template <typename First, typename Second>
void parallel_invoke(First&& first, Second&& second) {
  if constexpr (detail::kPlainThreads) {
    auto other = std::async(std::launch::async, [&] { second(); });
    first();
    other.get();
  } else {
    tbb::parallel_invoke(first, second);
  }
}

/// Sorts [first, last) by `less`, in parallel. Not stable: `less` must order any two items that differ, so that the
/// result is the same for any number of threads.
template <typename Iterator, typename Less = std::less<>>
void parallel_sort(Iterator first, Iterator last, Less less = {}) {
  if constexpr (detail::kPlainThreads) {
    std::sort(first, last, less);
  } else {
    tbb::parallel_sort(first, last, less);
  }
}

}  // namespace selvage
