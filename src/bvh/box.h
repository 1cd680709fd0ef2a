#pragma once

#include "core/simd/simd.h"
#include "selvage/core/types.h"

#include <bit>
#include <limits>

namespace selvage {

// Everything here is inlined by force: kernels for different instruction sets use it, and must not share copies.

/// The float `steps` (-1, 0 or 1) after x in the order of floats.
SELVAGE_INLINE float neighbour_float(float x, std::int32_t steps) {
  const auto ordered = [](std::int32_t bits) { return bits ^ ((bits >> 31) & 0x7fffffff); };
  return std::bit_cast<float>(ordered(ordered(std::bit_cast<std::int32_t>(x)) + steps));
}

/// Largest float that is not above x, for any double but NaN: -inf below the range of floats.
SELVAGE_INLINE float round_down(double x) {
  const float nearest = static_cast<float>(x);
  return neighbour_float(nearest, -static_cast<std::int32_t>(static_cast<double>(nearest) > x));
}

/// Smallest float that is not below x, for any double but NaN: +inf above the range of floats.
SELVAGE_INLINE float round_up(double x) {
  const float nearest = static_cast<float>(x);
  return neighbour_float(nearest, static_cast<std::int32_t>(static_cast<double>(nearest) < x));
}

/// Axis-aligned box in single precision that contains what it bounds: rounded outward.
struct Box {
  std::array<float, 3> lower;
  std::array<float, 3> upper;

  /// A box that contains nothing and grows by merging.
  SELVAGE_INLINE static Box empty() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  }

  SELVAGE_INLINE void merge(const Box& other) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = lower[axis] < other.lower[axis] ? lower[axis] : other.lower[axis];
      upper[axis] = upper[axis] > other.upper[axis] ? upper[axis] : other.upper[axis];
    }
  }

  /// Half of the surface area.
  SELVAGE_INLINE float half_area() const {
    const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
    return x * y + y * z + z * x;
  }

  bool operator==(const Box&) const = default;
};

/// The box between two corners of doubles, rounded outward; the z of a planar box is 0.
template <int D>
SELVAGE_INLINE Box enclosing_box(const Vec<D>& lower, const Vec<D>& upper) {
  Box box{};
  for (int axis = 0; axis < D; ++axis) {
    box.lower[axis] = round_down(lower.data()[axis]);
    box.upper[axis] = round_up(upper.data()[axis]);
  }
  return box;
}

/// Smallest box of floats that contains all points; the z of a planar point is 0.
template <int D>
SELVAGE_INLINE Box bounding_box(std::span<const Vec<D>> points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Box box{};
  for (int axis = 0; axis < D; ++axis) {
    double lower = kInfinity, upper = -kInfinity;
    for (const Vec<D>& point : points) {
      const double x = point.data()[axis];
      lower = x < lower ? x : lower;
      upper = x > upper ? x : upper;
    }
    box.lower[axis] = round_down(lower);
    box.upper[axis] = round_up(upper);
  }
  return box;
}

}  // namespace selvage
