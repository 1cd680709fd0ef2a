#pragma once

#include "selvage/core/types.h"

#include <cmath>

namespace selvage {

/// A lower bound of the distance between a segment (a point, where its ends are equal) and a tetrahedron: the largest
/// gap between the two along a few directions. 0 where none tells them apart. Any shape is allowed. What rounding adds
/// is below 2^-48 of the largest coordinate. Once it is known to be at least `enough`, that may be the answer.
double distance_bound(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron,
                      double enough = HUGE_VAL);

}  // namespace selvage
