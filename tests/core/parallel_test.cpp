#include "core/parallel.h"
#include "threads.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>
#include <stdexcept>
#include <vector>

namespace selvage {
namespace {

TEST(Parallel, RangesCoverEveryItemOnce) {
  for (const std::int64_t count : {0, 1, 7, 64, 1000, 12345}) {
    for (const std::int64_t grain : {1, 10, 100000}) {
      std::vector<int> visits(count, 0);
      parallel_ranges(count, grain, [&](std::int64_t first, std::int64_t last) {
        EXPECT_LT(first, last);
        for (std::int64_t i = first; i < last; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " items, grain " << grain;
    }
  }
}

TEST(Parallel, ForCallsEveryItemOnce) {
  std::vector<int> visits(5000, 0);
  parallel_for(5000, 16, [&](std::int64_t i) { ++visits[i]; });
  EXPECT_EQ(visits, std::vector<int>(5000, 1));
}

TEST(Parallel, LoopsNest) {
  std::vector<std::vector<int>> rows(8);
  parallel_for(8, 1, [&](std::int64_t i) {
    rows[i].assign(300, 0);
    parallel_for(300, 50, [&](std::int64_t k) { rows[i][k] = static_cast<int>(i * k); });
  });
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k < 300; ++k) EXPECT_EQ(rows[i][k], i * k);
}

TEST(Parallel, ExceptionsReachTheCaller) {
  const auto loop = [] {
    parallel_for(1000, 10, [](std::int64_t i) {
      if (i == 321) throw std::runtime_error("321");
    });
  };
  EXPECT_THROW(loop(), std::runtime_error);
}

struct Extent {
  std::int64_t lowest = 1 << 20, highest = -1, count = 0;
  void add(const Extent& other) {
    lowest = std::min(lowest, other.lowest);
    highest = std::max(highest, other.highest);
    count += other.count;
  }
};

TEST(Parallel, ReduceSeesEveryItemOnce) {
  for (const std::int64_t count : {0, 1, 77, 54321}) {
    const auto extent = parallel_reduce<Extent>(count, 100, [](std::int64_t first, std::int64_t last, Extent& result) {
      result.add({first, last - 1, last - first});
    });
    EXPECT_EQ(extent.count, count);
    EXPECT_EQ(extent.lowest, count == 0 ? 1 << 20 : 0);
    EXPECT_EQ(extent.highest, count - 1);
  }
}

TEST(Parallel, ListIfIsAscendingForAnyNumberOfThreads) {
  const auto is_listed = [](std::int64_t i) { return i % 7 == 3; };
  for (const std::int64_t count : {0, 3, 4, 54321}) {
    std::vector<std::int64_t> expected;
    for (std::int64_t i = 0; i < count; ++i)
      if (is_listed(i)) expected.push_back(i);
    EXPECT_EQ(test::same_for_any_threads([&] { return parallel_list_if(count, 10, is_listed); }), expected) << count;
  }
}

TEST(Parallel, InvokeCallsBoth) {
  int a = 0, b = 0;
  parallel_invoke([&] { a = 1; }, [&] { b = 2; });
  EXPECT_EQ(a, 1);
  EXPECT_EQ(b, 2);
}

TEST(Parallel, SortIsTheSameForAnyNumberOfThreads) {
  std::mt19937 random(1);
  std::vector<std::pair<unsigned, int>> items(50000);
  for (int i = 0; i < 50000; ++i) items[i] = {random() % 100, i};
  auto expected = items;
  std::sort(expected.begin(), expected.end());
  for (const int threads : {1, 2, 4}) {
    tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    auto sorted = items;
    parallel_sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, expected) << threads << " threads";
  }
  parallel_sort(items.begin(), items.end(), std::greater<>());
  EXPECT_TRUE(std::is_sorted(items.begin(), items.end(), std::greater<>()));
}

}  // namespace
}  // namespace selvage
