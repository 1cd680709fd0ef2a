#pragma once

namespace selvage {

/// Radius of the tips of a squishy ball's tentacles, the thinnest place.
double squishy_tip_radius(double radius, int tentacles);

/// Radius of the tips of an octopus's arms, the thinnest place.
double octopus_tip_radius(double size, double slenderness = 1);

/// The coarsest cell that follows an arm: every ball in it holds a lattice vertex, with room for vertices that move.
inline double coarsest_cell(double thinnest_radius) {
  return 1.2 * thinnest_radius;
}

}  // namespace selvage
