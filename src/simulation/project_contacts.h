#pragma once

#include "selvage/contact/contact.h"
#include "selvage/contact/friction.h"
#include "simulation/material_blocks.h"
#include "simulation/obstacle.h"

namespace selvage {

/// Moves vertices out of every contact, one after the other in the order given, and holds back what slides.
///
/// @param start  (n_vertices) positions at the start of the step
/// @param grips  (n_contacts) of this step; updated
void project_contacts(std::span<const Contact> contacts, std::span<const Vec3> start, const Friction& friction,
                      std::span<Grip> grips, std::span<VertexRow> vertices);

/// Moves vertices out of obstacles, which move from their places at the time `from` to those at the time `to`.
/// Parallel.
///
/// @param grips  (n_vertices x n_obstacles) of this step; updated
/// @return how many contacts there were
std::int64_t project_obstacles(std::span<const Obstacle> obstacles, double from, double to, std::span<const Vec3> start,
                               std::span<Grip> grips, std::span<VertexRow> vertices);

}  // namespace selvage
