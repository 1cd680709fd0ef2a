#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

namespace selvage::test {

/// A number of random inputs, multiplied by the environment variable SELVAGE_TEST_SCALE (a positive number; 1 when it
/// is unset or not a number), and at least 1: one test text serves the short run, the sanitizers and the long run.
inline std::int64_t scaled(std::int64_t n) {
  const char* text = std::getenv("SELVAGE_TEST_SCALE");
  const double scale = text != nullptr ? std::strtod(text, nullptr) : 1;
  if (!(scale > 0)) return n;
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(static_cast<double>(n) * scale));
}

/// The seed of a test's random inputs, another one for every value of the environment variable SELVAGE_TEST_SEED (a
/// whole number; the everyday inputs when it is unset or 0).
inline std::uint64_t seed(std::uint64_t n) {
  const char* text = std::getenv("SELVAGE_TEST_SEED");
  return n + 1'000'003 * (text != nullptr ? std::strtoull(text, nullptr, 10) : 0);
}

}  // namespace selvage::test
