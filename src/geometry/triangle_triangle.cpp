#include "selvage/geometry/triangle_triangle.h"

#include <algorithm>

#include "geometry/flat_contact.h"
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
    const auto shadow = [k](const Vec3& p) { return Vec2(p[k], p[(k + 1) % 3]); };
    const Vec2 start = shadow(a[0]), end = shadow(a[1]), apex_a = shadow(a[2]), apex_b = shadow(b[2]);
    const int side_of_a = orient2d(start, end, apex_a), side_of_b = orient2d(start, end, apex_b);
    if (side_of_a != 0 && side_of_a == side_of_b) return true;
    on_one_line &= side_of_a == 0 && side_of_b == 0 && orient2d(start, apex_a, apex_b) == 0;
  }
  // Both stick out at the same end exactly when the way from one apex to the other does not pass the edge.
  return on_one_line && classify_flat_contact({a[2], b[2], b[2]}, {a[0], a[1], a[1]}) == TriangleContact::kDisjoint;
}

}  // namespace detail

}  // namespace selvage
