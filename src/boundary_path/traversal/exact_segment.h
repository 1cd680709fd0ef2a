#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// The feature of a boundary face on which a candidate lies, as positions: a vertex, an edge or (3D) a triangle, of
/// which the first `count` entries hold the vertices.
template <int D>
struct TargetSimplex {
  int count = 0;
  std::array<Vec<D>, D> vertices;
};

/// Vertices of the face of an element.
template <int D>
using FacePoints = std::array<Vec<D>, D>;

/// Exact decisions about the segment from p to s, the orthogonal projection of p onto the affine hull of a target
/// simplex.
///
/// s itself is not a double in general, so that every predicate is a polynomial of the given coordinates, evaluated in
/// integers. This is the fallback for what the floating-point filters of the traversal cannot decide. About a
/// microsecond a decision; side() and, in space, touches() first ask double-double arithmetic, which decides all but
/// zero in a tenth of that. Never overflows, for any finite coordinates.
template <int D>
class ExactSegment {
 public:
  ExactSegment(const Vec<D>& p, const TargetSimplex<D>& target) : p_(p), target_(target) {}

  /// Sign of det(s - p, a - p) in the plane, of det(s - p, a - p, b - p) in space: `points` holds a (and b).
  int side(const std::array<Vec<D>, D - 1>& points) const;

  /// Signs of the orientation of (face, p) and of (face, s).
  int side_of_start(const FacePoints<D>& face) const;
  int side_of_end(const FacePoints<D>& face) const;

  /// Whether the closed segment meets the closed face.
  bool touches(const FacePoints<D>& face) const;

  /// Whether the line through p and s meets the closed face no farther than 2 |p - s| from s.
  bool touches_within_reach(const FacePoints<D>& face) const;

  /// Whether the line crosses the plane of the face no farther than 2 |p - s| from s. True when the line lies in it.
  bool crosses_within_reach(const FacePoints<D>& face) const;

 private:
  Vec<D> p_;
  TargetSimplex<D> target_;
};

extern template class ExactSegment<2>;
extern template class ExactSegment<3>;

/// Which vertices (bits) span the feature of a boundary face that holds its point closest to p; decided exactly. A flat
/// triangle is the union of its edges.
unsigned exact_closest_mask(const Vec2& p, const std::array<Vec2, 2>& face);
unsigned exact_closest_mask(const Vec3& p, const std::array<Vec3, 3>& face);

/// s - p, off by less than 2^-52 of its largest coordinate, and the barycentric coordinates of s with respect to the
/// target's vertices, each to 2^-52 of itself. For targets that double precision cannot resolve: p close to a face, or
/// a sliver. The target is not flat.
template <int D>
struct PreciseOffset {
  Vec<D> offset;
  std::array<double, D> barycentric{};
};
template <int D>
PreciseOffset<D> precise_offset(const Vec<D>& p, const TargetSimplex<D>& target);

extern template PreciseOffset<2> precise_offset<2>(const Vec2&, const TargetSimplex<2>&);
extern template PreciseOffset<3> precise_offset<3>(const Vec3&, const TargetSimplex<3>&);

}  // namespace selvage
