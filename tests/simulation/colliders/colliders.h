#pragma once

#include "selvage/simulation/collider.h"

namespace selvage::colliders {

/// A solid box of eight corners.
inline MeshShape solid_box(const Vec3& lower, const Vec3& upper) {
  MeshShape shape;
  for (int i = 0; i < 8; ++i)
    shape.positions.push_back(
        {(i & 1) != 0 ? upper[0] : lower[0], (i & 2) != 0 ? upper[1] : lower[1], (i & 4) != 0 ? upper[2] : lower[2]});
  shape.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return shape;
}

/// Points of its twelve edges, ends included.
inline std::vector<Vec3> edge_points(const Vec3& lower, const Vec3& upper, int per_edge) {
  std::vector<Vec3> points;
  for (int axis = 0; axis < 3; ++axis)
    for (int corner = 0; corner < 4; ++corner)
      for (int k = 0; k < per_edge; ++k) {
        Vec3 p;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        p[axis] = lower[axis] + (upper[axis] - lower[axis]) * k / (per_edge - 1);
        p[u] = (corner & 1) != 0 ? upper[u] : lower[u];
        p[v] = (corner & 2) != 0 ? upper[v] : lower[v];
        points.push_back(p);
      }
  return points;
}

}  // namespace selvage::colliders
