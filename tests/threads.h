#pragma once

#include <tbb/global_control.h>

#include <gtest/gtest.h>

namespace selvage::test {

/// The result of `compute()` where so many threads are allowed.
template <typename Compute>
auto with_threads(int count, Compute&& compute) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
  return compute();
}

/// The result of `compute()` with one thread. Fails where it differs with more.
template <typename Compute>
auto same_for_any_threads(Compute&& compute) {
  const auto one = with_threads(1, compute);
  for (const int count : {2, 5}) EXPECT_TRUE(with_threads(count, compute) == one) << count << " threads";
  return one;
}

}  // namespace selvage::test
