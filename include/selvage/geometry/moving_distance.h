#pragma once

#include "selvage/geometry/continuous.h"

namespace selvage {

/// Whether a moving vertex and a moving face (point 0; points 1 to 3) come nearer than a distance at some time in
/// [0, 1]: true wherever they do, and nowhere where they stay farther than (1 + 2^-20) times the distance; both up to
/// rounding in a distance. Never for a distance of 0.
bool vertex_comes_near_face(const MovingPoints& points, double distance);

/// The same for two moving edges (points 0 and 1; points 2 and 3).
bool edge_comes_near_edge(const MovingPoints& points, double distance);

}  // namespace selvage
