#pragma once

#include "core/parallel.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace selvage {

/// One pass of a radix sort: brings items into the order of a digit, those with equal digits as they stand. Parallel;
/// the same for any number of threads.
///
/// @param to  of the same size
/// @param digit  `std::uint32_t digit(const Item&)`, below `digit_count`
template <typename Item, typename Digit>
void sort_by_digit(const std::vector<Item>& from, std::vector<Item>& to, std::uint32_t digit_count, Digit&& digit) {
  constexpr std::int64_t kMinChunk = 1 << 15, kMaxChunks = 16;
  const std::int64_t count = std::ssize(from);
  const std::int64_t chunks = std::clamp<std::int64_t>(count / kMinChunk, 1, kMaxChunks);
  const auto begin = [&](std::int64_t chunk) { return count * chunk / chunks; };
  // Per chunk how many items have each digit, then where the next one goes.
  std::vector<std::int64_t> places(chunks * digit_count);
  parallel_for(chunks, 1, [&](std::int64_t c) {
    for (std::int64_t i = begin(c); i < begin(c + 1); ++i) ++places[c * digit_count + digit(from[i])];
  });
  std::int64_t place = 0;
  for (std::uint32_t d = 0; d < digit_count; ++d)
    for (std::int64_t c = 0; c < chunks; ++c) place += std::exchange(places[c * digit_count + d], place);
  parallel_for(chunks, 1, [&](std::int64_t c) {
    std::int64_t* const next = places.data() + c * digit_count;
    for (std::int64_t i = begin(c); i < begin(c + 1); ++i) to[next[digit(from[i])]++] = from[i];
  });
}

}  // namespace selvage
