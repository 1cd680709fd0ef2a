#pragma once

#include "core/simd/simd.h"
#include "geometry/orientation_filter.h"
#include "selvage/geometry/triangle_triangle.h"

#include <array>
#include <cmath>

/// The floating-point stage of the tests of two triangles, for loops and kernels that want it inline.
namespace selvage {
namespace detail {

/// Heights of three points over the plane of a triangle, times twice its area: det(t1 - t0, t2 - t0, p - t0), each with
/// the same bound of its error.
struct Heights {
  double value[3];
  double error;
};

bool triangles_meet_exact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, const Heights& of_a,
                          const Heights& of_b);
bool meet_beyond_vertex_exact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, const Heights& of_a,
                              const Heights& of_b);
bool meet_beyond_edge_exact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

inline namespace SELVAGE_ISA {

/// The bounds are those of `orient3d`, with the largest of the three factors on each axis in place of each one's own.
SELVAGE_INLINE Heights heights_over(const std::array<Vec3, 3>& triangle, const std::array<Vec3, 3>& points) {
  double u[3], v[3], w[3][3], reach[3];
  for (int k = 0; k < 3; ++k) {
    const double origin = triangle[0][k];
    u[k] = triangle[1][k] - origin;
    v[k] = triangle[2][k] - origin;
    for (int i = 0; i < 3; ++i) w[i][k] = points[i][k] - origin;
    const double x = std::abs(w[0][k]), y = std::abs(w[1][k]), z = std::abs(w[2][k]);
    const double larger = x > y ? x : y;
    reach[k] = larger > z ? larger : z;
  }
  const double yz = u[1] * v[2], zy = u[2] * v[1];
  const double zx = u[2] * v[0], xz = u[0] * v[2];
  const double xy = u[0] * v[1], yx = u[1] * v[0];
  const double normal[3] = {yz - zy, zx - xz, xy - yx};
  const double bound = reach[0] * (std::abs(yz) + std::abs(zy)) + reach[1] * (std::abs(zx) + std::abs(xz)) +
                       reach[2] * (std::abs(xy) + std::abs(yx));
  Heights heights;
  for (int i = 0; i < 3; ++i) heights.value[i] = w[i][0] * normal[0] + w[i][1] * normal[1] + w[i][2] * normal[2];
  heights.error = kRelativeError3d * bound + kUnderflowError * (1 + reach[0] + reach[1] + reach[2]);
  return heights;
}

/// Whether the heights from the given one on are certainly all positive or all negative. False where anything has
/// overflowed: the error has, too.
template <int First>
SELVAGE_INLINE bool on_one_side(const Heights& heights) {
  bool above = true, below = true;
  for (int i = First; i < 3; ++i) {
    above &= heights.value[i] > heights.error;
    below &= heights.value[i] < -heights.error;
  }
  return above | below;
}

}  // namespace SELVAGE_ISA
}  // namespace detail

}  // namespace selvage
