#pragma once

#include "selvage/core/types.h"

namespace selvage::cli {

/// How well shaped the elements of a mesh are. Elements without size count with angles 0 and ratio 0.
struct Quality {
  double smallest_angle = 0, mean_smallest_angle = 0,
         largest_angle = 0;                ///< dihedral in space, inner in the plane [deg]
  double worst_ratio = 0, mean_ratio = 0;  ///< D times inradius over circumradius: 1 for the regular simplex
  double measure = 0;                      ///< volume or area: the sum over the elements, inverted ones negative
};

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexTuple<4>> tetrahedra);

/// The measure is the sum of the triangles' areas, none negative.
Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexTuple<3>> triangles);

}  // namespace selvage::cli
