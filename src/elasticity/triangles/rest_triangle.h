#pragma once

#include "elasticity/simplex_element.h"

namespace selvage {

/// A triangle at rest, laid into its own plane with the first axis along the part of a direction that lies in it.
/// Where the direction is across the triangle, the first axis is along its first edge.
/// @param corners  that span an area
/// @param along    of any length but 0
RestSimplex<2> rest_triangle(const StencilPositions<3>& corners, const Eigen::Vector3d& along);

}  // namespace selvage
