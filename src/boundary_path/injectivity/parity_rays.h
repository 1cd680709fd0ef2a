#pragma once

#include "core/simd/simd.h"

namespace selvage {
inline namespace SELVAGE_ISA {

/// From every vertex two rays start, in one fixed direction (shear, 1) and in the opposite one. How many elements at a
/// vertex hold a ray tells whether they cover directions twice: see docs/how_it_works/boundary_path.md. The direction
/// is one that no face is likely to be parallel to.
inline constexpr float kRayShear[2] = {0.13579f, 0.27183f};

/// On which sides of its faces the rays from an element's vertices start.
///
/// @param edges  from vertex 0 of the element to the others
/// @param shear  kRayShear
/// @param sides  component of each face's inward normal along the ray, faces numbered as the vertices opposite to them:
///               their sum is 0. The forward ray of vertex k starts into a positive element when all but sides[k] are
///               positive, the backward one when all but sides[k] are negative.
/// @return       the determinant of the edges
template <typename Number>
SELVAGE_INLINE Number ray_sides(const Number (&edges)[3][3], const Number (&shear)[2], Number (&sides)[4]) {
  // A shear that takes the ray to the last axis changes neither the determinant nor what the ray passes.
  Number flat[3][2];
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 2; ++i) flat[k][i] = edges[k][i] - shear[i] * edges[k][2];
  const auto cross = [](const Number(&a)[2], const Number(&b)[2]) { return a[0] * b[1] - a[1] * b[0]; };
  sides[1] = cross(flat[1], flat[2]);
  sides[2] = cross(flat[2], flat[0]);
  sides[3] = cross(flat[0], flat[1]);
  const Number sum = sides[1] + sides[2] + sides[3];
  sides[0] = sum - (sum + sum);
  return edges[0][2] * sides[1] + edges[1][2] * sides[2] + edges[2][2] * sides[3];
}

template <typename Number>
SELVAGE_INLINE Number ray_sides(const Number (&edges)[2][2], const Number (&shear)[2], Number (&sides)[3]) {
  const Number first = edges[0][0] - shear[0] * edges[0][1], second = edges[1][0] - shear[0] * edges[1][1];
  sides[0] = second - first;
  sides[1] = (first - first) - second;
  sides[2] = first;
  return edges[0][1] * sides[1] + edges[1][1] * sides[2];
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
