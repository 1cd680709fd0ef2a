#pragma once

#include "selvage/contact/contact.h"
#include "simulation/material_blocks.h"
#include "simulation/obstacle.h"

namespace selvage {

/// Coefficients of friction.
struct Friction {
  double at_rest, sliding;
};

/// Moves vertices out of every contact, one after the other in the order given, and holds back what slides.
///
/// @param start  (n_vertices) positions at the start of the step
void project_contacts(std::span<const Contact> contacts, std::span<const Vec3> start, Friction friction,
                      std::span<VertexRow> vertices);

/// Moves vertices out of obstacles, which move from their places at the time `from` to those at the time `to`.
/// Parallel.
///
/// @return how many there were
std::int64_t project_obstacles(std::span<const Obstacle> obstacles, double from, double to, std::span<const Vec3> start,
                               std::span<VertexRow> vertices);

}  // namespace selvage
