#include "core/merge_sorted.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace selvage {
namespace {

using Item = std::pair<Index, Index>;

/// So many distinct items below the bounds, in no order, dealt out to lists, of which some stay empty.
std::vector<std::vector<Item>> deal_items(std::size_t count, Index first_bound, Index second_bound) {
  std::mt19937 random(static_cast<std::uint32_t>(count));
  const auto below = [&](Index bound) { return std::uniform_int_distribution<Index>(0, bound - 1)(random); };
  std::vector<Item> items;
  while (items.size() < count) {
    while (items.size() < count) items.emplace_back(below(first_bound), below(second_bound));
    std::sort(items.begin(), items.end());
    items.erase(std::unique(items.begin(), items.end()), items.end());
  }
  std::shuffle(items.begin(), items.end(), random);
  std::vector<std::vector<Item>> lists(9);
  for (const Item& item : items) lists[below(5)].push_back(item);
  return lists;
}

struct MergeCase {
  std::size_t count;
  Index first_bound;
  Index second_bound;
};

class MergeSorted : public testing::TestWithParam<MergeCase> {};

TEST_P(MergeSorted, GivesWhatStdSortGives) {
  const auto [count, first_bound, second_bound] = GetParam();
  const auto lists = deal_items(count, first_bound, second_bound);
  std::vector<Item> expected;
  for (const auto& list : lists) expected.insert(expected.end(), list.begin(), list.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_TRUE(merge_sorted(std::span<const std::vector<Item>>(lists), &Item::first, &Item::second) == expected);
}

constexpr Index kHighestKey = std::numeric_limits<Index>::max();

INSTANTIATE_TEST_SUITE_P(Sizes, MergeSorted,
                         testing::Values(MergeCase{0, 1, 1}, MergeCase{1, 1, 1}, MergeCase{255, 20, 20},
                                         MergeCase{256, 16, 16}, MergeCase{300, 1, 300}, MergeCase{300, 300, 1},
                                         MergeCase{1'000, kHighestKey, kHighestKey}, MergeCase{5'000, 3, kHighestKey},
                                         MergeCase{70'000, 90'000, 90'000}, MergeCase{200'000, 1'000, 2'000'000}));

}  // namespace
}  // namespace selvage
