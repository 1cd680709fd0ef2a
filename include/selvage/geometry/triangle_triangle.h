#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "selvage/core/simd.h"
#include "selvage/core/types.h"

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
/// they are disjoint or overlap in one plane. Whether there is one is exact; each end is within 2^-40 of the length of
/// the edge it lies on of the true point, plus the rounding of its coordinates.
std::optional<std::array<Vec3, 2>> intersection_segment(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

inline namespace SELVAGE_ISA {

/// Whether the triangles a and b have a common point: `classify_contact` is not `kDisjoint`. Exact for all finite
/// doubles, degenerate triangles included. What the filter decides, inlines.
bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles with the common vertex a[0] = b[0] have any other common point. Exact for all finite doubles;
/// a triangle may be degenerate.
bool meet_beyond_vertex(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles with the common edge a[0] = b[0], a[1] = b[1] have a common point off the segment from a[0] to
/// a[1]: they are folded onto each other in one plane, or both are degenerate and stick out of the edge at the same
/// end. Exact for all finite doubles; the edge may be a point.
bool meet_beyond_edge(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace SELVAGE_ISA
}  // namespace selvage
