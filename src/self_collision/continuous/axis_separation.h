#pragma once

#include "self_collision/surface/continuous_input.h"

namespace selvage {

/// Whether an axis shows that a vertex and a face, or two edges, stay apart during the step, by their thickness: one
/// across both, or one in their plane across an edge. Where features are coplanar, as those of a flat sheet, no
/// direction across both says anything, and the exact test is dear. In doubles, with their rounding: never true where
/// they meet.
///
/// @param vertices     of the first, then of the second
/// @param first_count  1: a vertex and a face; 2: two edges
bool stay_apart_by_axis(const ContinuousInput& input, const std::array<Index, 4>& vertices, int first_count);

/// Whether none of them moves.
bool are_still(const ContinuousInput& input, const std::array<Index, 4>& vertices);

}  // namespace selvage
