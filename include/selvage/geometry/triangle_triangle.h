#pragma once

#include <array>
#include <cstdint>
#include <optional>

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
/// they are disjoint or overlap in one plane. Whether there is one, and whether it is a point, is exact, and so is an
/// end at a vertex; any other end is off by at most 2^-40 of the edge it lies on and two roundings of its coordinates.
std::optional<std::array<Vec3, 2>> intersection_segment(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether the triangles a and b have a common point: `classify_contact` is not `kDisjoint`. Exact for all finite
/// doubles, degenerate triangles included.
bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles with the common vertex a[0] = b[0] have any other common point. Exact for all finite doubles;
/// a triangle may be degenerate.
bool meet_beyond_vertex(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// Whether two triangles with the common edge a[0] = b[0], a[1] = b[1] have a common point off the segment from a[0] to
/// a[1]: they are folded onto each other in one plane, or both are degenerate and stick out of the edge at the same
/// end. Exact for all finite doubles; the edge may be a point.
bool meet_beyond_edge(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace selvage
