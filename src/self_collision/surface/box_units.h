#pragma once

#include "bvh/box.h"

#include <cmath>

namespace selvage {

/// Bound of the error of a coordinate in box units: a unit in the last place of floats below 1, plus the rounding of
/// the doubles before.
inline constexpr float kBoxRounding = 0x1.01p-24f;

/// The map of positions to single precision: scaled by powers of two and moved, so that the surface's middle is the
/// origin, where floats are finest, and its half size about 1, so that products neither overflow nor vanish.
///
/// The map is monotone in each coordinate, rounding included, so that boxes that meet before meet after.
class BoxUnits {
 public:
  BoxUnits() = default;

  /// The units of the box between two corners.
  BoxUnits(const Vec3& lower, const Vec3& upper) {
    const double largest = std::max(lower.cwiseAbs().maxCoeff(), upper.cwiseAbs().maxCoeff());
    const int exponent = largest > 0 ? std::ilogb(largest) : 0;
    // By two factors: 2^-exponent itself may overflow.
    half_ = std::ldexp(1.0, -exponent / 2);
    rest_ = std::ldexp(1.0, -exponent - -exponent / 2);
    const Vec3 low = lower * half_ * rest_, high = upper * half_ * rest_;
    origin_ = (low + high) / 2;
    const double extent = (high - low).maxCoeff();
    if (extent > 0) zoom_ = std::ldexp(1.0, -std::ilogb(extent));
  }

  /// A position in box units: no coordinate is larger than 1.
  Vec3 map(const Vec3& x) const { return (x * half_ * rest_ - origin_) * zoom_; }

  /// A length in box units.
  double map_length(double length) const { return length * half_ * rest_ * zoom_; }

 private:
  double half_ = 1, rest_ = 1, zoom_ = 1;
  Vec3 origin_ = Vec3::Zero();
};

}  // namespace selvage
