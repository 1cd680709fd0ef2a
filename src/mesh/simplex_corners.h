#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Positions of the vertices of a simplex.
template <std::size_t N>
std::array<Vec3, N> corners_of(const std::array<Index, N>& vertices, std::span<const Vec3> positions) {
  std::array<Vec3, N> corners;
  for (std::size_t i = 0; i < N; ++i) corners[i] = positions[vertices[i]];
  return corners;
}

/// Whether two simplices have a vertex in common.
template <std::size_t N, std::size_t M>
bool share_vertex(const std::array<Index, N>& a, const std::array<Index, M>& b) {
  for (const Index v : a)
    for (const Index w : b)
      if (v == w) return true;
  return false;
}

/// Twice the area of a triangle times its unit normal.
inline Vec3 area_normal(const std::array<Vec3, 3>& corners) {
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]);
}

}  // namespace selvage
