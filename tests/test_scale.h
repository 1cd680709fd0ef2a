#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace selvage::test {

/// A number of random inputs, multiplied by the environment variable SELVAGE_TEST_SCALE (a positive number; 1 when it
/// is unset or not a number), and at least `least`: one test text serves the short run, the sanitizers and the long
/// run.
inline std::int64_t scaled(std::int64_t n, std::int64_t least = 1) {
  const char* text = std::getenv("SELVAGE_TEST_SCALE");
  const double scale = text != nullptr ? std::strtod(text, nullptr) : 1;
  if (!(scale > 0)) return n;
  return std::max(least, static_cast<std::int64_t>(static_cast<double>(n) * scale));
}

/// Of `count` random cases the number that must be of a kind that is expected in more than the given share: less by
/// four standard deviations, so that it holds in a small run too.
inline std::int64_t quota(std::int64_t count, double share) {
  const double expected = static_cast<double>(count) * share;
  return static_cast<std::int64_t>(std::floor(expected - 4 * std::sqrt(expected)));
}

/// The seed of a test's random inputs, another one for every value of the environment variable SELVAGE_TEST_SEED (a
/// whole number; the everyday inputs when it is unset or 0).
inline std::uint64_t seed(std::uint64_t n) {
  const char* text = std::getenv("SELVAGE_TEST_SEED");
  return n + 1'000'003 * (text != nullptr ? std::strtoull(text, nullptr, 10) : 0);
}

}  // namespace selvage::test
