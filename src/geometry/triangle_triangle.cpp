#include "selvage/geometry/triangle_triangle.h"

#include <algorithm>
#include <cmath>

#include "geometry/exact/exact_integer.h"
#include "geometry/flat_contact.h"
#include "geometry/triangle_filter.h"
#include "selvage/geometry/predicates.h"

namespace selvage {

namespace {

using Triangle = std::array<Vec3, 3>;
using Signs = std::array<int, 3>;
using detail::Heights;

/// The sides of a triangle's plane on which three points lie.
Signs sides_of(const Triangle& triangle, const Triangle& points, const Heights& heights) {
  Signs signs;
  for (int i = 0; i < 3; ++i) {
    signs[i] = detail::certain_sign(heights.value[i], heights.error);
    if (signs[i] == 0) signs[i] = detail::orient3d_exact(triangle[0], triangle[1], triangle[2], points[i]);
  }
  return signs;
}

bool strictly_on_one_side(const Signs& signs) {
  return signs[0] != 0 && signs[0] == signs[1] && signs[0] == signs[2];
}

bool on_both_sides(const Signs& signs) {
  return std::min({signs[0], signs[1], signs[2]}) < 0 && std::max({signs[0], signs[1], signs[2]}) > 0;
}

/// Two triangles whose planes cross in one line, listed so that the first vertex of each is above the other's plane,
/// or on it with the other two below; the others are not above. Each triangle then cuts the line, if at all, in the
/// segment between its two edges at the first vertex, and these edges cross the other's plane properly.
struct FacingPair {
  Triangle a, b;
};

/// The vertex that is alone on its side. The other two may be on the plane, not both with it.
int lone_vertex(const Signs& signs) {
  int i = 0;
  const auto alone = [&] {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    return signs[i] != signs[j] && signs[i] != signs[k] && signs[j] * signs[k] >= 0;
  };
  while (!alone()) ++i;
  return i;
}

FacingPair face_each_other(const Triangle& a, const Triangle& b, const Signs& of_a, const Signs& of_b) {
  const int i = lone_vertex(of_a), j = lone_vertex(of_b);
  FacingPair pair{{a[i], a[(i + 1) % 3], a[(i + 2) % 3]}, {b[j], b[(j + 1) % 3], b[(j + 2) % 3]}};
  // Turning a triangle over turns the signs of the other around.
  if (of_a[i] < of_a[(i + 1) % 3]) std::swap(pair.b[1], pair.b[2]);
  if (of_b[j] < of_b[(j + 1) % 3]) std::swap(pair.a[1], pair.a[2]);
  return pair;
}

/// The line common to the planes of a facing pair is met by a between its edges 01 and 02, by b between its edges 02
/// and 01, in this order. Negative when, along the line, edge 0i of a comes before edge 0j of b, 0 when both meet it in
/// one point.
int compare_on_line(const FacingPair& pair, int i, int j) {
  return orient3d(pair.a[0], pair.a[i], pair.b[0], pair.b[j]);
}

TriangleContact classify(const Triangle& a, const Triangle& b, const Heights& heights_of_a,
                         const Heights& heights_of_b) {
  const Signs of_b = sides_of(a, b, heights_of_b);
  if (strictly_on_one_side(of_b)) return TriangleContact::kDisjoint;
  const Signs of_a = sides_of(b, a, heights_of_a);
  if (strictly_on_one_side(of_a)) return TriangleContact::kDisjoint;
  if (of_a == Signs{} || of_b == Signs{}) return classify_flat_contact(a, b);
  const FacingPair pair = face_each_other(a, b, of_a, of_b);
  const int before = compare_on_line(pair, 1, 1);
  if (before > 0) return TriangleContact::kDisjoint;
  const int after = compare_on_line(pair, 2, 2);
  if (after < 0) return TriangleContact::kDisjoint;
  const bool interiors_meet = before != 0 && after != 0 && on_both_sides(of_a) && on_both_sides(of_b);
  return interiors_meet ? TriangleContact::kCrossing : TriangleContact::kTouching;
}

/// How far from p to q the plane of the triangle is, between p and q, which lie on different sides of it.
double exact_way_to_plane(const Vec3& p, const Vec3& q, const Triangle& triangle) {
  using boost::multiprecision::cpp_int, boost::multiprecision::cpp_rational;
  const std::array<Vec3, 5> points{triangle[0], triangle[1], triangle[2], p, q};
  std::array<double, 15> values;
  for (int i = 0; i < 15; ++i) values[i] = points[i / 3][i % 3];
  std::array<ExactInt, 15> integers;
  to_common_integers(values, integers);
  const auto x = [&](int point, int k) { return integers[3 * point + k % 3] - integers[k % 3]; };
  ExactInt heights[2]{};
  for (int k = 0; k < 3; ++k) {
    const ExactInt normal = x(1, k + 1) * x(2, k + 2) - x(1, k + 2) * x(2, k + 1);
    for (int i = 0; i < 2; ++i) heights[i] += normal * x(3 + i, k);
  }
  const ExactInt p_height = abs(heights[0]), q_height = abs(heights[1]);
  return cpp_rational(cpp_int(p_height), cpp_int(p_height + q_height)).convert_to<double>();
}

/// Where the segment from p to q meets the plane of the triangle; its ends are not both on the plane nor on one side.
Vec3 cut_by_plane(const Vec3& p, const Vec3& q, const Triangle& triangle) {
  const Triangle ends{p, q, q};
  const Heights heights = detail::heights_over(triangle, ends);
  const Signs signs = sides_of(triangle, ends, heights);
  if (signs[0] == 0) return p;
  if (signs[1] == 0) return q;
  const double drop = heights.value[0] - heights.value[1];
  constexpr double kLargestError = 0x1p-42;  // of the way; the two heights together make three times as much
  const bool accurate = heights.error < kLargestError * std::abs(drop);
  const double way = accurate ? heights.value[0] / drop : exact_way_to_plane(p, q, triangle);
  return (1 - way) * p + way * q;
}

using Segment = std::array<Vec3, 2>;

/// The common points of a facing pair that meets.
Segment common_segment(const FacingPair& pair) {
  const auto cut_a = [&](int i) { return cut_by_plane(pair.a[0], pair.a[i], pair.b); };
  const auto cut_b = [&](int i) { return cut_by_plane(pair.b[0], pair.b[i], pair.a); };
  for (int i = 1; i <= 2; ++i) {
    if (compare_on_line(pair, i, i) != 0) continue;
    const Vec3 point = cut_a(i);
    return {point, point};
  }
  return {compare_on_line(pair, 1, 2) < 0 ? cut_b(2) : cut_a(1), compare_on_line(pair, 2, 1) < 0 ? cut_a(2) : cut_b(1)};
}

/// The common points of two triangles that touch in one plane, or of a segment and a triangle across it. In one plane,
/// where a line parts the two, these are common points of an edge or vertex of either: its ends are vertices.
Segment common_flat_segment(const Triangle& a, const Triangle& b) {
  std::array<Vec3, 6> common;
  auto end = common.begin();
  for (const Vec3& vertex : a)
    if (triangle_contains(b, vertex)) *end++ = vertex;
  for (const Vec3& vertex : b)
    if (triangle_contains(a, vertex)) *end++ = vertex;
  if (end != common.begin()) {
    const auto [low, high] = std::minmax_element(common.begin(), end, [](const Vec3& p, const Vec3& q) {
      return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    return {*low, *high};
  }
  const bool a_is_pierced = sides_of(a, b, detail::heights_over(a, b)) != Signs{};
  const Triangle &triangle = a_is_pierced ? a : b, &segment = a_is_pierced ? b : a;
  const Signs signs = sides_of(triangle, segment, detail::heights_over(triangle, segment));
  const auto [low, high] = std::minmax_element(signs.begin(), signs.end());
  const Vec3 point = cut_by_plane(segment[low - signs.begin()], segment[high - signs.begin()], triangle);
  return {point, point};
}

/// The triangle as two segments from vertex 0, where this vertex lies on the opposite edge.
std::array<Triangle, 2> split_at_first_vertex(const Triangle& t) {
  return {Triangle{t[0], t[1], t[1]}, Triangle{t[0], t[2], t[2]}};
}

/// Of two triangles with a common vertex 0, one at least is degenerate, or one plane holds both.
bool flat_pair_meets_beyond_vertex(const Triangle& a, const Triangle& b) {
  // Follow any other common point away from the common vertex: the ray leaves a or b, whichever comes first, through a
  // point of the opposite edge. That is another point than the vertex unless the vertex is on that edge.
  const auto opposite = [](const Triangle& t) { return Triangle{t[1], t[2], t[2]}; };
  for (const bool swapped : {false, true}) {
    const Triangle &first = swapped ? b : a, &second = swapped ? a : b;
    if (!triangle_contains(opposite(first), first[0])) continue;
    for (const Triangle& part : split_at_first_vertex(first))
      if (part[1] != part[0] && flat_pair_meets_beyond_vertex(part, second)) return true;
    return false;
  }
  return classify_flat_contact(opposite(a), b) != TriangleContact::kDisjoint ||
         classify_flat_contact(opposite(b), a) != TriangleContact::kDisjoint;
}

}  // namespace

TriangleContact classify_contact(const Triangle& a, const Triangle& b) {
  return classify(a, b, detail::heights_over(b, a), detail::heights_over(a, b));
}

std::optional<Segment> intersection_segment(const Triangle& a, const Triangle& b) {
  const Heights heights_of_a = detail::heights_over(b, a), heights_of_b = detail::heights_over(a, b);
  const TriangleContact contact = classify(a, b, heights_of_a, heights_of_b);
  if (contact == TriangleContact::kDisjoint || contact == TriangleContact::kCoplanarOverlap) return std::nullopt;
  const Signs of_a = sides_of(b, a, heights_of_a), of_b = sides_of(a, b, heights_of_b);
  if (of_a == Signs{} || of_b == Signs{}) return common_flat_segment(a, b);
  return common_segment(face_each_other(a, b, of_a, of_b));
}

namespace detail {

bool triangles_meet_exact(const Triangle& a, const Triangle& b, const Heights& of_a, const Heights& of_b) {
  return classify(a, b, of_a, of_b) != TriangleContact::kDisjoint;
}

bool meet_beyond_vertex_exact(const Triangle& a, const Triangle& b, const Heights& heights_of_a,
                              const Heights& heights_of_b) {
  const Signs of_b = sides_of(a, b, heights_of_b), of_a = sides_of(b, a, heights_of_a);
  if (of_a == Signs{} || of_b == Signs{}) return flat_pair_meets_beyond_vertex(a, b);
  if (of_a[1] == of_a[2] || of_b[1] == of_b[2]) return false;
  // From the common vertex, each triangle reaches along the line common to both planes in one direction: with normals m
  // of a and n of b, a along m x n if its vertex 1 is the higher one, else against it; b the other way round.
  return (of_a[1] > of_a[2]) != (of_b[1] > of_b[2]);
}

bool meet_beyond_edge_exact(const Triangle& a, const Triangle& b) {
  if (orient3d(a[0], a[1], a[2], b[2]) != 0) return false;
  bool on_one_line = true;
  for (int k = 0; k < 3; ++k) {
    const auto project = [k](const Vec3& p) { return Vec2(p[k], p[(k + 1) % 3]); };
    const Vec2 start = project(a[0]), end = project(a[1]), apex_a = project(a[2]), apex_b = project(b[2]);
    const int side_of_a = orient2d(start, end, apex_a), side_of_b = orient2d(start, end, apex_b);
    if (side_of_a != 0 && side_of_a == side_of_b) return true;
    on_one_line &= side_of_a == 0 && side_of_b == 0 && orient2d(start, apex_a, apex_b) == 0;
  }
  // Both stick out at the same end exactly when the way from one apex to the other does not pass the edge.
  return on_one_line && classify_flat_contact({a[2], b[2], b[2]}, {a[0], a[1], a[1]}) == TriangleContact::kDisjoint;
}

}  // namespace detail

bool triangles_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, b);
  if (detail::on_one_side<0>(of_b)) return false;
  const detail::Heights of_a = detail::heights_over(b, a);
  if (detail::on_one_side<0>(of_a)) return false;
  return detail::triangles_meet_exact(a, b, of_a, of_b);
}

bool meet_beyond_vertex(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, b);
  if (detail::on_one_side<1>(of_b)) return false;
  const detail::Heights of_a = detail::heights_over(b, a);
  if (detail::on_one_side<1>(of_a)) return false;
  return detail::meet_beyond_vertex_exact(a, b, of_a, of_b);
}

bool meet_beyond_edge(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  const detail::Heights of_b = detail::heights_over(a, {b[2], b[2], b[2]});
  if (detail::on_one_side<2>(of_b)) return false;
  return detail::meet_beyond_edge_exact(a, b);
}

}  // namespace selvage
