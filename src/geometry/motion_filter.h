#pragma once

#include "core/simd/simd.h"
#include "geometry/orientation_filter.h"
#include "selvage/geometry/continuous.h"

#include <array>
#include <cmath>

/// The floating-point stage of the continuous tests, for loops and kernels that want it inline.
namespace selvage {
namespace detail {

/// The volume of the tetrahedron of four moving points, times 6, as a polynomial of time: its coefficients in Bernstein
/// form, each with the same bound of its error.
struct VolumeOverTime {
  double coefficient[4];
  double error;
};

bool vertex_meets_face_undecided(const MovingPoints& points, const VolumeOverTime& volume);
bool edge_meets_edge_undecided(const MovingPoints& points, const VolumeOverTime& volume);

inline namespace SELVAGE_ISA {

/// With edge vectors u, v and w that move from u0 to u1..., the volume's coefficients are sums of determinants of mixed
/// ends: det(u0, v0, w0); a third of det(u1, v0, w0) + det(u0, v1, w0) + det(u0, v0, w1); and so on. Rounding: one for
/// each of three differences, two for a product in a cross product and the difference, one where two cross products are
/// added, three for a dot product, two to add dot products and take a third: below 12 (1 + 2^-48) u of the sum of the
/// absolute values of all terms, which is no more than for the largest u, v and w on each axis. Four times that sum is
/// not exceeded by any sum on the way, so that nothing overflows before it does.
SELVAGE_INLINE VolumeOverTime volume_over_time(const MovingPoints& points) {
  constexpr double kRelativeError = 0x1p-51;  // of four times the sum: 16 u
  double u[2][3], v[2][3], w[2][3], reach[3][3];
  for (int k = 0; k < 3; ++k) {
    for (int end = 0; end < 2; ++end) {
      const auto& x = end == 0 ? points.t0 : points.t1;
      u[end][k] = x[1][k] - x[0][k];
      v[end][k] = x[2][k] - x[0][k];
      w[end][k] = x[3][k] - x[0][k];
    }
    const auto larger = [k](const double(&a)[2][3]) {
      const double first = std::abs(a[0][k]), second = std::abs(a[1][k]);
      return first > second ? first : second;
    };
    reach[0][k] = larger(u);
    reach[1][k] = larger(v);
    reach[2][k] = larger(w);
  }
  double start[3], mixed[3], end[3], bound = 0;
  for (int k = 0; k < 3; ++k) {
    const int l = k == 2 ? 0 : k + 1, m = k == 0 ? 2 : k - 1;
    start[k] = v[0][l] * w[0][m] - v[0][m] * w[0][l];
    end[k] = v[1][l] * w[1][m] - v[1][m] * w[1][l];
    mixed[k] = (v[0][l] * w[1][m] - v[0][m] * w[1][l]) + (v[1][l] * w[0][m] - v[1][m] * w[0][l]);
    bound += reach[0][k] * (4 * (reach[1][l] * reach[2][m] + reach[1][m] * reach[2][l]));
  }
  const auto dot = [](const double(&a)[3], const double(&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  return {{dot(u[0], start), (dot(u[1], start) + dot(u[0], mixed)) / 3, (dot(u[0], end) + dot(u[1], mixed)) / 3,
           dot(u[1], end)},
          kRelativeError * bound + kUnderflowError * (1 + reach[0][0] + reach[0][1] + reach[0][2])};
}

/// Whether the four points are certainly never in one plane: all Bernstein coefficients of the volume have one sign
/// (the first case of BSC, Bernstein sign classification).
SELVAGE_INLINE bool never_zero(const VolumeOverTime& volume) {
  bool above = true, below = true;
  for (double coefficient : volume.coefficient) {
    above &= coefficient > volume.error;
    below &= coefficient < -volume.error;
  }
  return above | below;
}

/// Whether, along one axis, the first `Count` points are before all others at both ends of time, or behind them: then
/// they are so at all times, by linearity.
template <int Count>
SELVAGE_INLINE bool apart_on_an_axis(const MovingPoints& points) {
  bool apart = false;
  for (int k = 0; k < 3; ++k) {
    bool before = true, behind = true;
    for (int i = 0; i < Count; ++i)
      for (int j = Count; j < 4; ++j) {
        before &= points.t0[i][k] < points.t0[j][k];
        before &= points.t1[i][k] < points.t1[j][k];
        behind &= points.t0[i][k] > points.t0[j][k];
        behind &= points.t1[i][k] > points.t1[j][k];
      }
    apart |= before | behind;
  }
  return apart;
}

}  // namespace SELVAGE_ISA
}  // namespace detail

}  // namespace selvage
