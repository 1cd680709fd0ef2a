#pragma once

#include "selvage/core/parallel.h"
#include "selvage/core/types.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace selvage {

/// For each vertex the tuples that have it, ascending: `items[first[v] .. first[v + 1])`. O(n), parallel where there
/// are many.
template <int N>
void build_vertex_stars(Index vertex_count, std::span<const VertexTuple<N>> tuples, std::vector<Index>& items,
                        std::vector<Index>& first) {
  constexpr std::int64_t kTuplesAtOnce = 8192, kFewTuples = 1 << 18;
  first.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  items.resize(tuples.size() * N);
  // Atomic additions cost five times as much as plain ones, and leave items to be sorted.
  if (std::ssize(tuples) < kFewTuples) {
    for (const VertexTuple<N>& tuple : tuples)
      for (const Index v : tuple) ++first[v];
    std::exclusive_scan(first.begin(), first.end(), first.begin(), Index{0});
    std::vector<Index> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < tuples.size(); ++t)
      for (const Index v : tuples[t]) items[next[v]++] = static_cast<Index>(t);
    return;
  }
  parallel_for(std::ssize(tuples), kTuplesAtOnce, [&](std::int64_t t) {
    for (Index v : tuples[t]) std::atomic_ref(first[v]).fetch_add(1, std::memory_order_relaxed);
  });
  // first[v] becomes the end of v's share; filling from the back turns it into the beginning.
  std::inclusive_scan(first.begin(), first.end(), first.begin());
  parallel_for(std::ssize(tuples), kTuplesAtOnce, [&](std::int64_t t) {
    for (Index v : tuples[t])
      items[std::atomic_ref(first[v]).fetch_sub(1, std::memory_order_relaxed) - 1] = static_cast<Index>(t);
  });
  parallel_for(vertex_count, kTuplesAtOnce,
               [&](std::int64_t v) { std::sort(items.begin() + first[v], items.begin() + first[v + 1]); });
}

}  // namespace selvage
