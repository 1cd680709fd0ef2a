#pragma once

#include "selvage/core/parallel.h"
#include "selvage/core/types.h"

#include <functional>
#include <numeric>

namespace selvage {

/// Sorts lists of distinct items, each with a key in [0, key_count), into one, by `<`, which orders by the key first:
/// all with the same key are brought together, then sorted. The same for any number of threads.
///
/// @param key  member of an item that is its key
template <typename Item, typename Key>
std::vector<Item> merge_sorted(std::span<const std::vector<Item>> lists, Index key_count, Key key) {
  const auto list_count = static_cast<std::int64_t>(lists.size());
  std::vector<std::int64_t> place(static_cast<std::size_t>(key_count) + 1, 0);
  parallel_for(list_count, 1, [&](std::int64_t l) {
    for (const Item& item : lists[l])
      std::atomic_ref(place[std::invoke(key, item) + 1]).fetch_add(1, std::memory_order_relaxed);
  });
  std::partial_sum(place.begin(), place.end(), place.begin());
  std::vector<Item> items(place.back());
  // Afterwards place[i] is the end of the items of key i, whatever order threads came in.
  parallel_for(list_count, 1, [&](std::int64_t l) {
    for (const Item& item : lists[l])
      items[std::atomic_ref(place[std::invoke(key, item)]).fetch_add(1, std::memory_order_relaxed)] = item;
  });
  parallel_for(key_count, 1024, [&](std::int64_t i) {
    const std::int64_t first = i == 0 ? 0 : place[i - 1];
    if (place[i] - first > 1) std::sort(items.begin() + first, items.begin() + place[i]);
  });
  return items;
}

}  // namespace selvage
