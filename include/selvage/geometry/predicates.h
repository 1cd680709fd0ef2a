#pragma once

#include <array>

#include "selvage/core/types.h"

namespace selvage {

/// Sign of the area of the triangle (a, b, c): 1 counter-clockwise, -1 clockwise, 0 exactly collinear.
/// Exact for all finite doubles, including denormals and magnitudes whose products overflow or underflow.
int orient2d(const Vec2& a, const Vec2& b, const Vec2& c);

/// Sign of det(b - a, c - a, d - a): 1 for a positive tetrahedron (a, b, c, d), -1 for an inverted one, 0 exactly flat.
/// Exact for all finite doubles, including denormals and magnitudes whose products overflow or underflow.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The same for any dimension: sign of the signed volume of a simplex.
int orientation(const std::array<Vec2, 3>& simplex);
int orientation(const std::array<Vec3, 4>& simplex);

/// Where a point lies in a simplex, decided exactly.
struct Containment {
  bool inside = false;     ///< in the closed simplex
  unsigned zero_mask = 0;  ///< bit i: the i-th barycentric coordinate is exactly 0, the point is on face i; 0 outside
};

/// Whether p lies in the closed simplex, and on which of its faces. An inverted simplex is the same set as its mirror
/// image; an exactly flat simplex contains nothing. Exact for all finite doubles.
template <int D>
Containment locate_in_simplex(const std::array<Vec<D>, D + 1>& simplex, const Vec<D>& p);

extern template Containment locate_in_simplex<2>(const std::array<Vec2, 3>&, const Vec2&);
extern template Containment locate_in_simplex<3>(const std::array<Vec3, 4>&, const Vec3&);

}  // namespace selvage
