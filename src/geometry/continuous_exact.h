#pragma once

#include "selvage/geometry/continuous.h"

#include <optional>

namespace selvage {

/// Which two sets the four points are: a vertex and a face, or two edges.
enum class ContinuousPair : std::uint8_t { kVertexFace, kEdgeEdge };

/// The steps into which times of impact part the time from 0 to 1; a power of two.
inline constexpr int kTimeSteps = 1 << 20;

/// Whether the closed sets meet at some time from 0 to last_step / kTimeSteps, ends included, by integer polynomials;
/// for all finite doubles.
bool meets_exactly(ContinuousPair pair, const MovingPoints& points, int last_step = kTimeSteps);

/// The step in which they do so first: the first i for which they meet up to (i + 1) / kTimeSteps. Nothing where they
/// do not up to `last_step`, a power of two.
std::optional<int> first_step_exactly(ContinuousPair pair, const MovingPoints& points, int last_step);

}  // namespace selvage
