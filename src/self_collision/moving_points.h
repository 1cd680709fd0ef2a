#pragma once

#include "self_collision/continuous_scene.h"
#include "selvage/geometry/continuous.h"

namespace selvage {

inline MovingPoints moving_points(const ContinuousScene& scene, const std::array<Index, 4>& vertices) {
  MovingPoints points;
  for (int i = 0; i < 4; ++i) {
    points.t0[i] = scene.positions_t0[vertices[i]];
    points.t1[i] = scene.positions_t1[vertices[i]];
  }
  return points;
}

/// A vertex and a face of the scene.
inline MovingPoints moving_points(const ContinuousScene& scene, Index vertex, Index face) {
  const auto& [a, b, c] = scene.triangles[face].vertices;
  return moving_points(scene, {vertex, a, b, c});
}

/// Two edges of the scene.
inline MovingPoints moving_edges(const ContinuousScene& scene, Index first, Index second) {
  const auto &a = scene.edges[first], &b = scene.edges[second];
  return moving_points(scene, {a[0], a[1], b[0], b[1]});
}

}  // namespace selvage
