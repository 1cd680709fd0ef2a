#pragma once

#include <array>
#include <optional>

#include "selvage/core/types.h"

namespace selvage {

/// Four points that move on straight lines at constant speed, from their places at time 0 to those at time 1; at time
/// t each is at (1 - t) x_t0 + t x_t1, in exact arithmetic. Either a vertex and the three of a face, or the two ends of
/// an edge and the two of another.
struct MovingPoints {
  std::array<Vec3, 4> t0, t1;
};

/// The first time at which a moving vertex and a moving face meet: no later than the true one and at most 2^-20 (below
/// 1e-6) earlier, never below 0. Nothing exactly when `vertex_meets_face` is false, or when that time is not below
/// `before`: for the earliest of many, pass the earliest so far: it saves time.
std::optional<double> vertex_face_impact(const MovingPoints& points, double before = 1);

/// The same for two moving edges.
std::optional<double> edge_edge_impact(const MovingPoints& points, double before = 1);

/// Whether a moving vertex and a moving face (point 0; points 1 to 3), as closed sets, meet at some time in [0, 1].
/// Exact for all finite doubles: no motion, motion that stays in one plane, contact at a single instant and degenerate
/// faces included.
///
/// The signs of Bernstein coefficients decide most pairs, as in Bernstein sign classification (BSC: Tang, Tong, Wang,
/// Manocha 2014, EDC's reference 20); halves of the time decide most others; integers decide the rest.
bool vertex_meets_face(const MovingPoints& points);

/// The same for two moving edges (points 0 and 1; points 2 and 3).
bool edge_meets_edge(const MovingPoints& points);

}  // namespace selvage
