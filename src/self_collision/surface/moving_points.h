#pragma once

#include "self_collision/surface/continuous_input.h"
#include "selvage/geometry/continuous.h"

#include <algorithm>

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

/// The sum of the thickness of a vertex and a face, or of two edges; 0 where the input has none. [m]
inline double thickness_of(const ContinuousInput& input, Index vertex, Index face) {
  const double* const of = input.vertex_thickness;
  if (of == nullptr) return 0;
  const auto& [a, b, c] = input.triangles[face].vertices;
  return of[vertex] + std::max({of[a], of[b], of[c]});
}
inline double thickness_of_edges(const ContinuousInput& input, Index first, Index second) {
  const double* const of = input.vertex_thickness;
  if (of == nullptr) return 0;
  const auto &a = input.edges[first], &b = input.edges[second];
  return std::max(of[a[0]], of[a[1]]) + std::max(of[b[0]], of[b[1]]);
}

/// Two edges of the input.
inline MovingPoints moving_edges(const ContinuousInput& input, Index first, Index second) {
  const auto &a = input.edges[first], &b = input.edges[second];
  return moving_points(input, {a[0], a[1], b[0], b[1]});
}

}  // namespace selvage
