#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "selvage/core/simd.h"
#include "selvage/core/types.h"
#include "selvage/geometry/predicates.h"

namespace selvage {

/// How two triangles meet, as closed sets: the convex hulls of their vertices. A triangle of collinear vertices is a
/// segment, one of equal vertices a point; the interior of each is meant within its own plane, line or point, so that
/// the interior of a segment is the segment without its ends, and that of a point the point itself.
enum class TriangleContact : std::uint8_t {
  kDisjoint,         ///< no common point
  kTouching,         ///< common points, but not of the two interiors
  kCrossing,         ///< the interiors meet, and no plane holds both
  kCoplanarOverlap,  ///< the interiors meet, and one plane holds both
};

/// How the triangles a and b meet. A segment that pierces a triangle crosses it; two segments that cross in one plane,
/// collinear ones with more than an end in common, and a point inside a triangle overlap. The same for every order of
/// the vertices and of the two triangles. Exact for all finite doubles.
TriangleContact classify_contact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// The common points of two triangles that touch or cross: a segment, of equal ends where it is a point. Nothing where
/// they are disjoint or overlap in one plane. Whether there is one, and whether it is a point, is exact, and so is an
/// end at a vertex; any other end is off by at most 2^-40 of the edge it lies on and two roundings of its coordinates.
std::optional<std::array<Vec3, 2>> intersection_segment(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

// What follows is the fast path, here so that it inlines into loops and kernels; the exact stages are out of line.
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

inline namespace SELVAGE_ISA {

/// Whether the triangles a and b have a common point: `classify_contact` is not `kDisjoint`. Exact for all finite
/// doubles, degenerate triangles included.
SELVAGE_INLINE bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, b);
  if (detail::on_one_side<0>(of_b)) return false;
  const detail::Heights of_a = detail::heights_over(b, a);
  if (detail::on_one_side<0>(of_a)) return false;
  return detail::triangles_meet_exact(a, b, of_a, of_b);
}

/// Whether two triangles with the common vertex a[0] = b[0] have any other common point. Exact for all finite doubles;
/// a triangle may be degenerate.
SELVAGE_INLINE bool meet_beyond_vertex(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, b);
  if (detail::on_one_side<1>(of_b)) return false;
  const detail::Heights of_a = detail::heights_over(b, a);
  if (detail::on_one_side<1>(of_a)) return false;
  return detail::meet_beyond_vertex_exact(a, b, of_a, of_b);
}

/// Whether two triangles with the common edge a[0] = b[0], a[1] = b[1] have a common point off the segment from a[0] to
/// a[1]: they are folded onto each other in one plane, or both are degenerate and stick out of the edge at the same
/// end. Exact for all finite doubles; the edge may be a point.
SELVAGE_INLINE bool meet_beyond_edge(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, {b[2], b[2], b[2]});
  if (detail::on_one_side<2>(of_b)) return false;
  return detail::meet_beyond_edge_exact(a, b);
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
