#pragma once

#include "boundary_path/queries.h"

namespace selvage::families {

/// A situation of the paper with the answer found by hand.
struct Figure {
  std::string name;
  Pieces<2> mesh;
  Query<2> query;
  double distance;  ///< negative: no path
  Vec2 closest;
};

/// Figures 2 to 7 of SPB, built by hand in the plane.
std::vector<Figure> paper_figures();

/// A bar along x whose far end turns back and comes down into it from above: the tip, at height `tip`, lies inside the
/// bar, which is one high. Elements 0 to 9 are the bar; the last two are the tip.
Pieces<2> hook(double tip);

/// A wide strip of layers at the given heights; a layer whose upper height is the smaller one is inverted.
Pieces<2> layers(const std::vector<double>& heights);

}  // namespace selvage::families
