#pragma once

#include "selvage/core/types.h"

#include <optional>

namespace selvage {

/// Where the middle of the part of a segment inside a tetrahedron is: 0 at the segment's first end, 1 at its second.
/// Nothing where no part is inside, or so short a one that its middle, rounded, is not (decided exactly). A flat
/// tetrahedron holds nothing, an inverted one what its mirror image holds.
std::optional<double> middle_of_part(const std::array<Vec3, 2>& segment, const std::array<Vec3, 4>& tetrahedron);

}  // namespace selvage
