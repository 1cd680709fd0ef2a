#include "core/phases.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <numeric>
#include <thread>

namespace selvage {
namespace {

/// Phases of so many items.
std::vector<Index> phases_of(const std::vector<Index>& counts) {
  std::vector<Index> first = {0};
  for (const Index count : counts) first.push_back(first.back() + count);
  return first;
}

/// A little work, more for some.
double work_on(Index item) {
  double sum = 0;
  for (int i = 0; i < (item % 7 == 0 ? 20'000 : 500); ++i) sum += 1.0 / (1 + i);
  return sum;
}

class PhasesOfThreads : public testing::TestWithParam<int> {};

TEST_P(PhasesOfThreads, EveryItemIsDoneOnceAndAfterAllOfThePhaseBefore) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, GetParam());
  tbb::task_arena arena(GetParam());
  for (const std::vector<Index>& counts :
       std::vector<std::vector<Index>>{{}, {0}, {1}, {5, 0, 3}, {1, 1, 1, 1}, {40, 2, 64, 9}, {0, 0, 1000}}) {
    const std::vector<Index> first = phases_of(counts);
    for (int round = 0; round < 50; ++round) {
      std::vector<Index> visits(first.back()), seen(first.back());
      arena.execute([&] {
        parallel_phases(first, [&](Index item, Index next) {
          EXPECT_GE(next, 0);
          EXPECT_LT(next, first.back());
          ++visits[item];
          // Not atomic: that what others wrote can be read is part of what is tested.
          const Index phase =
              static_cast<Index>(std::upper_bound(first.begin(), first.end(), item) - first.begin()) - 1;
          seen[item] = std::accumulate(visits.begin(), visits.begin() + first[phase], Index{work_on(item) < 0});
        });
      });
      for (std::size_t phase = 0; phase < counts.size(); ++phase)
        for (Index item = first[phase]; item < first[phase + 1]; ++item) {
          EXPECT_EQ(visits[item], 1);
          EXPECT_EQ(seen[item], first[phase]);
        }
    }
  }
}

TEST_P(PhasesOfThreads, CanBeBegunInsideALoop) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, GetParam());
  const std::vector<Index> first = phases_of({10, 20, 10});
  std::vector<std::vector<int>> visits(20, std::vector<int>(first.back()));
  parallel_for(20, 1, [&](std::int64_t i) { parallel_phases(first, [&](Index item, Index) { ++visits[i][item]; }); });
  for (const auto& of_one : visits) EXPECT_EQ(of_one, std::vector<int>(first.back(), 1));
}

// Many more threads than cores, of which most sleep at any moment, some inside an item and some between two phases; and
// several callers at once, each with phases of its own. What waits gives the processor away, so that all ends.
TEST(Phases, EndWithMoreThreadsThanCores) {
  const int threads = 8 * static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  const std::vector<Index> first = phases_of({3, 1, 64, 2, 2, 200, 1, 1, 1, 17});
  const auto run = [&] {
    tbb::task_arena arena(threads);
    for (int round = 0; round < 20; ++round) {
      std::vector<int> visits(first.back());
      std::atomic<int> too_early = 0;
      std::vector<std::atomic<int>> done(first.size());
      arena.execute([&] {
        parallel_phases(first, [&](Index item, Index) {
          const auto phase = std::upper_bound(first.begin(), first.end(), item) - first.begin() - 1;
          if (phase > 0 && done[phase - 1] != first[phase] - first[phase - 1]) ++too_early;
          if ((item + round) % 13 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
          ++visits[item];
          ++done[phase];
        });
      });
      EXPECT_EQ(too_early, 0);
      EXPECT_EQ(visits, std::vector<int>(first.back(), 1));
    }
  };
  std::vector<std::thread> callers;
  for (int i = 0; i < 4; ++i) callers.emplace_back(run);
  for (std::thread& caller : callers) caller.join();
}

INSTANTIATE_TEST_SUITE_P(Threads, PhasesOfThreads, testing::Values(1, 2, 3, 8));

}  // namespace
}  // namespace selvage
