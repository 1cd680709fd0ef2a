#pragma once

#include "self_collision/surface/continuous_input.h"
#include "selvage/geometry/continuous.h"

namespace selvage {

inline MovingPoints moving_points(const ContinuousInput& input, const std::array<Index, 4>& vertices) {
  MovingPoints points;
  for (int i = 0; i < 4; ++i) {
    points.t0[i] = input.positions_t0[vertices[i]];
    points.t1[i] = input.positions_t1[vertices[i]];
  }
  return points;
}

/// A vertex and a face of the input.
inline MovingPoints moving_points(const ContinuousInput& input, Index vertex, Index face) {
  const auto& [a, b, c] = input.triangles[face].vertices;
  return moving_points(input, {vertex, a, b, c});
}

/// Two edges of the input.
inline MovingPoints moving_edges(const ContinuousInput& input, Index first, Index second) {
  const auto &a = input.edges[first], &b = input.edges[second];
  return moving_points(input, {a[0], a[1], b[0], b[1]});
}

}  // namespace selvage
