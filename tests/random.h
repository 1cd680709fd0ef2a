#pragma once

#include <cstdint>
#include <random>

#include "selvage/core/types.h"

namespace selvage::test {

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// In [0, 1).
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double within(double low, double high) { return low + (high - low) * unit(); }
  /// Each coordinate in [-reach, reach).
  Vec3 vector(double reach) {
    const double x = within(-reach, reach), y = within(-reach, reach), z = within(-reach, reach);
    return {x, y, z};
  }
  /// In [0, n).
  Index below(std::uint64_t n) { return static_cast<Index>(bits() % n); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace selvage::test
