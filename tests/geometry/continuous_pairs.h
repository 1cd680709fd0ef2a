#pragma once

#include <optional>

#include "geometry/exact/continuous_exact.h"

namespace selvage::test {

inline constexpr auto kVertexFace = ContinuousPair::kVertexFace;
inline constexpr auto kEdgeEdge = ContinuousPair::kEdgeEdge;

/// Whether a pair of either kind meets.
inline bool meet(ContinuousPair pair, const MovingPoints& points) {
  return pair == kVertexFace ? vertex_meets_face(points) : edge_meets_edge(points);
}

/// Time of impact of a pair of either kind.
inline std::optional<double> impact(ContinuousPair pair, const MovingPoints& points, double before = 1) {
  return pair == kVertexFace ? vertex_face_impact(points, before) : edge_edge_impact(points, before);
}

}  // namespace selvage::test
