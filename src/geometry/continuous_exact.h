#pragma once

#include "selvage/geometry/continuous.h"

namespace selvage {

/// Which two sets the four points are: a vertex and a face, or two edges.
enum class ContinuousPair : std::uint8_t { kVertexFace, kEdgeEdge };

/// The steps into which `meets_exactly` can part the time from 0 to 1, to name a part of it.
inline constexpr int kTimeSteps = 1 << 20;

/// Whether the closed sets meet at some time from first_step / kTimeSteps to last_step / kTimeSteps, ends included, by
/// integer polynomials; for all finite doubles.
bool meets_exactly(ContinuousPair pair, const MovingPoints& points, int first_step = 0, int last_step = kTimeSteps);

}  // namespace selvage
