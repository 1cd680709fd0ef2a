#pragma once

#include "selvage/core/parallel.h"
#include "selvage/core/types.h"

#include <bit>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace selvage {

namespace detail {

/// One pass of a radix sort: brings items into the order of a digit, those with equal digits as they stand. Parallel.
///
/// @param digit  `std::uint32_t digit(const Item&)`, below `digit_count`
template <typename Item, typename Digit>
void sort_by_digit(const std::vector<Item>& from, std::vector<Item>& to, std::uint32_t digit_count, Digit&& digit) {
  constexpr std::int64_t kFewest = 1 << 15, kMostChunks = 16;
  const std::int64_t count = std::ssize(from);
  const std::int64_t chunks = std::clamp<std::int64_t>(count / kFewest, 1, kMostChunks);
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

}  // namespace detail

/// Sorts lists of distinct items into one, by two numbers of theirs that are not negative, of which no two items have
/// both in common: a radix sort. The same for any number of threads.
///
/// @param first, second  members of an item that are its numbers
template <typename Item, typename Number>
std::vector<Item> merge_sorted(std::span<const std::vector<Item>> lists, Number first, Number second) {
  constexpr std::size_t kFew = 256;
  constexpr int kMostBits = 12;
  std::vector<Item> items;
  std::size_t count = 0;
  for (const auto& list : lists) count += list.size();
  items.reserve(count);
  for (const auto& list : lists) items.insert(items.end(), list.begin(), list.end());
  if (count < kFew) {
    std::sort(items.begin(), items.end());
    return items;
  }
  Index firsts = 0, seconds = 0;
  for (const Item& item : items) {
    firsts |= std::invoke(first, item);
    seconds |= std::invoke(second, item);
  }
  const auto width = [](Index bits) { return std::bit_width(static_cast<std::uint32_t>(bits)); };
  const int shift = width(seconds), bits = width(firsts) + shift;
  const int passes = (bits + kMostBits - 1) / kMostBits;
  std::vector<Item> other(count);
  for (int pass = 0, from = 0; pass < passes; ++pass) {
    const int to = bits * (pass + 1) / passes;
    const std::uint32_t digit_count = 1u << (to - from);
    detail::sort_by_digit(items, other, digit_count, [&](const Item& item) {
      const std::uint64_t key = static_cast<std::uint64_t>(std::invoke(first, item)) << shift |
                                static_cast<std::uint64_t>(std::invoke(second, item));
      return static_cast<std::uint32_t>(key >> from) & (digit_count - 1);
    });
    std::swap(items, other);
    from = to;
  }
  return items;
}

}  // namespace selvage
