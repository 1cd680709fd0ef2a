#pragma once

#include "boundary_path/location/containment_kernel.h"
#include "core/simd/simd16.h"
#include "core/simd/vec3.h"

#include <bit>
#include <limits>

namespace selvage {
inline namespace SELVAGE_ISA {

/// Points or directions; the third coordinate is 0 in the plane.
using Vector16 = LaneVec3<Float16>;

/// Sixteen vertices as they are stored: see DeformedMesh::rounded_positions().
struct Vertices16 {
  Vector16 x;
  Float16 marks;

  SELVAGE_INLINE unsigned cullable() const { return sign_bits(marks); }
  /// Their numbers, as bits.
  SELVAGE_INLINE Float16 numbers() const {
    return and_bits(marks, Float16::broadcast(std::bit_cast<float>(std::numeric_limits<Index>::max())));
  }
};

/// @param vertex_of  the vertex of a lane
template <typename VertexOf>
SELVAGE_INLINE Vertices16 gather_vertices(const RoundedPosition* positions, VertexOf&& vertex_of) {
  const auto row = [&](int lane) { return Float4::load(positions[vertex_of(lane)].data()); };
  Float16 rows[4];
  for (int i = 0; i < 4; ++i)
    rows[i] = Float16::join(Float8::join(row(i), row(i + 4)), Float8::join(row(i + 8), row(i + 12)));
  transpose(rows[0], rows[1], rows[2], rows[3]);
  return {{{rows[0], rows[1], rows[2]}}, rows[3]};
}
template <typename VertexOf>
SELVAGE_INLINE Vector16 gather(const RoundedPosition* positions, VertexOf&& vertex_of) {
  return gather_vertices(positions, vertex_of).x;
}

/// Sixteen pairs of a point p and a boundary face, whose neighbours are known by their vertices that are not the face's
/// (apexes), numbered as the vertices of the face opposite to which they lie; from the box origin.
template <int D>
struct FaceView {
  Vector16 p;
  Vector16 corners[D];
  Vector16 apexes[D];
  unsigned cullable[D];       ///< pairs whose corner is
  unsigned has_neighbour[D];  ///< pairs whose neighbour opposite to the corner may be a candidate
  float rounding;             ///< twice what a coordinate may be off

  /// Bounds the squared distances from below. Any direction bounds the distance of a whole face, as far as the face
  /// reaches along it: the least of the corners does. So nothing depends on how good `to` is, the way from p to some
  /// point, but the quality of the bound.
  SELVAGE_INLINE Float16 squared_distance_along(const Vector16& to, const Float16& reach) const {
    const Float16 zero = Float16::broadcast(0), squared = dot(to, to);
    Float16 least = dot(corners[0] - p, to);
    for (int i = 1; i < D; ++i) least = min(least, dot(corners[i] - p, to));
    // Moving p and a corner by the rounding of each coordinate moves their distance by 2 sqrt(3) of it. Beside that
    // there are four roundings in a corner times `to` and four in the length and the quotient: each below 2^-24 of the
    // reach. Where squares may underflow nothing is known.
    const Float16 error = Float16::broadcast(0x1p-20f) * reach + Float16::broadcast(4 * rounding);
    const Float16 length = select_less(Float16::broadcast(1e-30f), squared, least / sqrt(squared), zero);
    const Float16 nearest = max(length - error, zero);
    return nearest * nearest * Float16::broadcast(1 - 0x1p-20f);
  }

  /// Let all coordinates be off by up to r / 2, edges be up to e and p be up to m from each vertex (sums of
  /// coordinates). A product of an edge and p's place is off by 2 m r and 5 units of 2^-24 e m; sums of up to eight of
  /// them are looked at, with as many roundings.
  SELVAGE_INLINE Float16 error_of_products(const Float16& reach, const Float16& extent) const {
    return reach * (Float16::broadcast(16 * rounding) + Float16::broadcast(0x1p-18f) * extent) +
           Float16::broadcast(1e-30f);
  }
};

/// Findings that are certain in single precision about the point s of each face that is closest to p.
template <int D>
struct FaceFindings {
  Float16 squared_distance;  ///< never above the true one
  Vector16 way;              ///< about from p to s
  unsigned closer[D];        ///< pairs where the neighbour opposite to a corner comes closer than s
  unsigned spans[D];         ///< pairs of which s's feature is certain, and the corner one of its vertices
  unsigned seen_outside;     ///< pairs where s is seen from outside

  /// Pairs where s is no answer.
  SELVAGE_INLINE unsigned culled() const {
    unsigned pairs = seen_outside;
    for (const unsigned neighbours : closer) pairs |= neighbours;
    return pairs;
  }
};

/// How p lies to the edges of a triangle (a, b, c): u from a to b, v from a to c, o from b to c.
struct TriangleProducts {
  Vector16 u, v, o, p_a;                 ///< the edges; p from a
  Float16 uu, uv, vv, oo;                ///< edge times edge
  Float16 u_a, v_a, u_b, v_c, o_b, o_c;  ///< edge times p from a corner
  Float16 t_u, t_v, t_o;                 ///< where along the edge p lies: 0 and 1 at its ends
  Float16 in_u, in_v, in_o;              ///< p across the edge, times the way from there to the third corner

  SELVAGE_INLINE TriangleProducts(const Vector16& p, const Vector16 (&corners)[3])
      : u(corners[1] - corners[0]), v(corners[2] - corners[0]), o(corners[2] - corners[1]), p_a(p - corners[0]) {
    uu = dot(u, u);
    uv = dot(u, v);
    vv = dot(v, v);
    oo = dot(o, o);
    u_a = dot(u, p_a);
    v_a = dot(v, p_a);
    u_b = u_a - uu;
    v_c = v_a - vv;
    o_b = v_a - uv - u_b;
    o_c = o_b - oo;
    t_u = u_a / uu;
    t_v = v_a / vv;
    t_o = o_b / oo;
    in_u = v_a - t_u * uv;
    in_v = u_a - t_v * uv;
    in_o = (Float16::broadcast(0) - u_b) - t_o * (uu - uv);
  }

  /// Positive where the foot of the perpendicular from p is inside.
  SELVAGE_INLINE Float16 inside() const { return min(in_u, min(in_v, in_o)); }

  /// The way from p to the best point of the three edges, or to the foot of the perpendicular where it is inside.
  /// Source: Ericson 2004, Real-Time Collision Detection, 5.1.5, for the signs that tell.
  SELVAGE_INLINE Vector16 way_to_face() const {
    const Float16 zero = Float16::broadcast(0), one = Float16::broadcast(1);
    const auto clamp = [&](const Float16& t) { return max(min(t, one), zero); };
    const Float16 on_u = clamp(t_u), on_v = clamp(t_v), on_o = clamp(t_o);
    // Squared distance of each edge's best point, less that of the first corner.
    const Float16 d_u = on_u * (on_u * uu - (u_a + u_a)), d_v = on_v * (on_v * vv - (v_a + v_a));
    const Float16 d_o = uu - (u_a + u_a) + on_o * (on_o * oo - (o_b + o_b)), d = min(d_u, d_v);
    Float16 weight_b = select_less(d_v, d_u, zero, on_u), weight_c = select_less(d_v, d_u, on_v, zero);
    weight_b = select_less(d_o, d, one - on_o, weight_b);
    weight_c = select_less(d_o, d, on_o, weight_c);
    const Float16 is_inside = inside(), scale = one / (uu * vv - uv * uv);
    weight_b = select_less(zero, is_inside, clamp((u_a * vv - v_a * uv) * scale), weight_b);
    weight_c = select_less(zero, is_inside, clamp((v_a * uu - u_a * uv) * scale), weight_c);
    return (weight_b * u + weight_c * v) - p_a;
  }
};

/// Finds pairs where s certainly lies on an edge across which the neighbour's direction comes closer, or at a vertex
/// from which one of the two does that are next to the face's own edges; or where s certainly lies inside the face, and
/// p before it. And which feature s lies on, where that is certain.
///
/// @param error   bounds the error of all products and of their sums here
/// @param extent  no two of the vertices are farther apart
SELVAGE_INLINE void find_culled(const FaceView<3>& view, const TriangleProducts& t, const Float16& error,
                                const Float16& extent, FaceFindings<3>& found) {
  // Where p certainly lies between the ends of an edge, the edge's square is above twice the error, and the quotient
  // t_u is off by less than two and a half errors over the square. Beyond the ends it may be larger than 1, but no more
  // than the triangle is slender.
  const Float16 zero = Float16::broadcast(0), two = Float16::broadcast(2), three = Float16::broadcast(3);
  const Float16 slender = extent / sqrt(min(t.uu, min(t.vv, t.oo))), wide = error * (two + three * slender);
  const Float16 minus_error = zero - error, minus_wide = zero - wide;
  const auto above = [&](const Float16& x) { return less_equal(error, x); };
  const auto below = [&](const Float16& x) { return less_equal(x, minus_error); };
  const auto beyond = [&](const Float16& in) { return less_equal(in, minus_wide); };
  const auto closer = [&](const Float16& x) { return less_equal(wide, x); };
  // The neighbours' directions: their apexes from the corners, times p from there.
  const Vector16 a_qc = view.apexes[2] - view.corners[0], a_qb = view.apexes[1] - view.corners[0];
  const Vector16 b_qa = view.apexes[0] - view.corners[1];
  const Float16 skew_u = dot(a_qc, t.u), skew_v = dot(a_qb, t.v), skew_o = dot(b_qa, t.o);
  const Float16 qc_a = dot(a_qc, t.p_a), qb_a = dot(a_qb, t.p_a), qa_b = dot(b_qa, t.p_a) - dot(b_qa, t.u);
  const Float16 qc_b = qc_a - t.u_a - (skew_u - t.uu), qb_c = qb_a - t.v_a - (skew_v - t.vv);
  const Float16 qa_c = qa_b - t.o_b - (skew_o - t.oo);
  const auto [has_qa, has_qb, has_qc] = view.has_neighbour;
  const auto [cull_a, cull_b, cull_c] = view.cullable;
  const unsigned at_a = below(t.u_a) & below(t.v_a), at_b = above(t.u_b) & below(t.o_b);
  const unsigned at_c = above(t.v_c) & above(t.o_c);
  const unsigned on_u = above(t.u_a) & below(t.u_b) & beyond(t.in_u);
  const unsigned on_v = above(t.v_a) & below(t.v_c) & beyond(t.in_v);
  const unsigned on_o = above(t.o_b) & below(t.o_c) & beyond(t.in_o);
  const unsigned is_inside = less_equal(wide * slender, t.inside());
  found.spans[0] = at_a | on_u | on_v | is_inside;
  found.spans[1] = at_b | on_u | on_o | is_inside;
  found.spans[2] = at_c | on_v | on_o | is_inside;
  const unsigned across_u = (cull_a | cull_b) & on_u & closer(qc_a - t.t_u * skew_u);
  const unsigned across_v = (cull_a | cull_c) & on_v & closer(qb_a - t.t_v * skew_v);
  const unsigned across_o = (cull_b | cull_c) & on_o & closer(qa_b - t.t_o * skew_o);
  const unsigned from_a = cull_a & at_a, from_b = cull_b & at_b, from_c = cull_c & at_c;
  found.closer[0] = has_qa & ((from_b & above(qa_b)) | (from_c & above(qa_c)) | across_o);
  found.closer[1] = has_qb & ((from_a & above(qb_a)) | (from_c & above(qb_c)) | across_v);
  found.closer[2] = has_qc & ((from_a & above(qc_a)) | (from_b & above(qc_b)) | across_u);
  found.seen_outside = is_inside & less_equal(error * extent, dot(cross(t.u, t.v), t.p_a));
}

SELVAGE_INLINE FaceFindings<3> look_at(const FaceView<3>& view) {
  const auto& [a, b, c] = view.corners;
  const auto& [qa, qb, qc] = view.apexes;
  const TriangleProducts t(view.p, view.corners);
  const Vector16 to = t.way_to_face();
  Float16 extent = max(max(abs_sum(t.u), abs_sum(t.v)), abs_sum(t.o));
  extent = max(extent, max(max(abs_sum(qc - a), abs_sum(qb - a)), abs_sum(qa - b)));
  const Float16 reach = abs_sum(to) + extent + extent + Float16::broadcast(4 * view.rounding);
  FaceFindings<3> found;
  found.squared_distance = view.squared_distance_along(to, reach);
  found.way = to;
  find_culled(view, t, view.error_of_products(reach, extent), extent, found);
  return found;
}

/// Squared distances from below alone, without neighbours.
SELVAGE_INLINE Float16 distances_from_below(const FaceView<3>& view) {
  const TriangleProducts t(view.p, view.corners);
  const Vector16 to = t.way_to_face();
  const Float16 extent = max(max(abs_sum(t.u), abs_sum(t.v)), abs_sum(t.o));
  return view.squared_distance_along(to, abs_sum(to) + extent + extent + Float16::broadcast(4 * view.rounding));
}

/// The same in the plane.
SELVAGE_INLINE FaceFindings<2> look_at(const FaceView<2>& view) {
  const Float16 zero = Float16::broadcast(0), one = Float16::broadcast(1);
  const auto& [a, b] = view.corners;
  const Vector16 u = b - a, p_a = view.p - a;
  const Float16 uu = dot(u, u), u_a = dot(u, p_a), u_b = u_a - uu;
  const Vector16 to = max(min(u_a / uu, one), zero) * u - p_a;
  const Vector16 a_qb = view.apexes[1] - a, b_qa = view.apexes[0] - b;
  const Float16 extent = max(abs_sum(u), max(abs_sum(a_qb), abs_sum(b_qa)));
  const Float16 reach = abs_sum(to) + extent + extent + Float16::broadcast(4 * view.rounding);
  const Float16 error = reach * (Float16::broadcast(16 * view.rounding) + Float16::broadcast(0x1p-18f) * extent) +
                        Float16::broadcast(1e-30f);
  FaceFindings<2> found;
  found.squared_distance = view.squared_distance_along(to, reach);
  found.way = to;
  found.closer[0] =
      view.cullable[1] & view.has_neighbour[0] & less_equal(error, u_b) & less_equal(error, dot(b_qa, view.p - b));
  found.closer[1] =
      view.cullable[0] & view.has_neighbour[1] & less_equal(u_a, zero - error) & less_equal(error, dot(a_qb, p_a));
  found.seen_outside = 0;
  found.spans[0] = found.spans[1] = 0;  // that nothing is certain costs little
  return found;
}

}  // namespace SELVAGE_ISA
}  // namespace selvage
