#pragma once

#include "selvage/geometry/continuous.h"

#include <optional>

namespace selvage {

/// Which two sets the four points are: a vertex and a face, or two edges.
enum class ContinuousPair : std::uint8_t { kVertexFace, kEdgeEdge };

/// The steps into which times of impact part the time from 0 to 1; a power of two.
inline constexpr int kTimeSteps = 1 << 20;

/// The first of the steps in which the closed sets meet, ends included: the first i for which they meet at some time up
/// to (i + 1) / kTimeSteps. `last_step` where they do not before its end.
int first_step_exactly(ContinuousPair pair, const MovingPoints& points, int last_step);

/// Whether they meet at some time from 0 to 1, ends included; for all finite doubles.
bool meets_exactly(ContinuousPair pair, const MovingPoints& points);

/// The stages of `first_step_exactly`, each alone, so that tests can hold one against the other.

/// By integers of fixed size, as long as they suffice: nothing where coordinates along one axis differ too much in
/// magnitude, or where a root is a multiple one, nearly so, or nearly that of another polynomial whose sign matters.
std::optional<int> first_step_by_fixed_integers(ContinuousPair pair, const MovingPoints& points, int last_step);

/// By integers of any size, for all finite doubles.
int first_step_by_any_integers(ContinuousPair pair, const MovingPoints& points, int last_step);

}  // namespace selvage
