#pragma once

#include <optional>

#include "selvage/geometry/continuous.h"

namespace selvage {

/// Whether a moving vertex and a moving face (point 0; points 1 to 3) come nearer than a distance at some time in
/// [0, 1]: true wherever they do, and nowhere where they stay farther than (1 + 2^-20) times the distance; both up to
/// rounding in a distance. Never for a distance of 0.
bool vertex_comes_near_face(const MovingPoints& points, double distance);

/// The same for two moving edges (points 0 and 1; points 2 and 3).
bool edge_comes_near_edge(const MovingPoints& points, double distance);

/// The first time at which a moving vertex and a moving face are nearer than a positive distance: no later than the
/// true one, up to rounding in a distance; 0 where they are nearer at the start. Nothing where they never are, or where
/// that time is not below `before`.
///
/// Hardly earlier either: at most 2^-20 of the step after it their distance is above the given one by at most 2^-20 of
/// it, or by what they move relative to each other in that time. A multiple of 2^-20; the same whatever `before` is.
std::optional<double> vertex_face_nearness(const MovingPoints& points, double distance, double before = 1);

/// The same for two moving edges.
std::optional<double> edge_edge_nearness(const MovingPoints& points, double distance, double before = 1);

}  // namespace selvage
