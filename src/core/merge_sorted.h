#pragma once

#include "core/sort_by_digit.h"
#include "selvage/core/types.h"

#include <bit>
#include <functional>
#include <span>
#include <vector>

namespace selvage {

/// Sorts lists of distinct items into one, by two numbers of theirs that are not negative, of which no two items have
/// both in common: a radix sort. The same for any number of threads.
///
/// @param first, second  members of an item that are its numbers
template <typename Item, typename Number>
std::vector<Item> merge_sorted(std::span<const std::vector<Item>> lists, Number first, Number second) {
  constexpr std::size_t kMinParallel = 256;
  constexpr int kMaxBits = 12;
  std::vector<Item> items;
  std::size_t count = 0;
  for (const auto& list : lists) count += list.size();
  items.reserve(count);
  for (const auto& list : lists) items.insert(items.end(), list.begin(), list.end());
  if (count < kMinParallel) {
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
  const int passes = (bits + kMaxBits - 1) / kMaxBits;
  std::vector<Item> other(count);
  for (int pass = 0, from = 0; pass < passes; ++pass) {
    const int to = bits * (pass + 1) / passes;
    const std::uint32_t digit_count = 1u << (to - from);
    sort_by_digit(items, other, digit_count, [&](const Item& item) {
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
