#pragma once

#include "core/parallel.h"
#include "selvage/core/error.h"
#include "selvage/core/types.h"

#include <fmt/format.h>

#include <atomic>
#include <limits>
#include <string_view>

namespace selvage {

/// The smallest offending index that parallel workers have found, so that an error does not depend on their order.
class FirstOffender {
 public:
  /// @param kind  what is numbered: "element", "triangle"
  explicit FirstOffender(std::string_view kind) : kind_(kind) {}

  void report(Index i) {
    Index seen = first_.load(std::memory_order_relaxed);
    while (i < seen && !first_.compare_exchange_weak(seen, i, std::memory_order_relaxed)) {
    }
  }
  bool any() const { return first_ != kNobody; }
  std::string name() const { return fmt::format("{} {}", kind_, first_.load()); }

 private:
  static constexpr Index kNobody = std::numeric_limits<Index>::max();
  std::string_view kind_;
  std::atomic<Index> first_{kNobody};
};

template <int N>
bool repeats_a_vertex(const VertexTuple<N>& tuple) {
  bool repeats = false;
  for (int i = 0; i < N; ++i)
    for (int k = 0; k < i; ++k) repeats |= tuple[i] == tuple[k];
  return repeats;
}

/// Checks the input of a mesh: there is a tuple, and each has distinct vertices in [0, vertex_count).
/// @throws Error  naming the first tuple that offends
template <int N>
void check_tuples(Index vertex_count, std::span<const VertexTuple<N>> tuples, std::string_view kind) {
  constexpr std::int64_t kTuplesAtOnce = 4096;
  if (tuples.empty()) throw Error("mesh", fmt::format("there is no {}", kind), "give at least one");
  if (tuples.size() >= (std::size_t{1} << 29))
    throw Error("mesh", fmt::format("{} {}s are too many", tuples.size(), kind), "the limit is 2^29 - 1");
  FirstOffender out_of_range(kind), repeated(kind);
  parallel_for(std::ssize(tuples), kTuplesAtOnce, [&](std::int64_t t) {
    for (Index v : tuples[t])
      if (v < 0 || v >= vertex_count) return out_of_range.report(static_cast<Index>(t));
    if (repeats_a_vertex<N>(tuples[t])) repeated.report(static_cast<Index>(t));
  });
  if (out_of_range.any())
    throw Error(out_of_range.name(), "a vertex index is out of range",
                fmt::format("indices must lie in [0, {})", vertex_count));
  if (repeated.any()) throw Error(repeated.name(), "repeats a vertex", "remove it, or give it distinct vertices");
}

}  // namespace selvage
