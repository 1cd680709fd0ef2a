#pragma once

#include "selvage/core/types.h"

#include <random>

/// Inputs of a measurement, few enough to stay in the cache.
inline constexpr std::size_t kCount = 1024;

/// The same random points in every run.
class RandomPoints {
 public:
  double uniform() { return distribution_(engine_); }
  selvage::Vec3 point(double reach = 1) { return reach * selvage::Vec3{uniform(), uniform(), uniform()}; }

 private:
  std::mt19937_64 engine_{1};
  std::uniform_real_distribution<double> distribution_{-1, 1};
};
