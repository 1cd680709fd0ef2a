#include "self_collision/oracle.h"

// GCC 12 takes the small buffer of a big integer for all of its room.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Warray-bounds"
#endif
#include <boost/multiprecision/cpp_int.hpp>

#include <algorithm>
#include <cmath>

namespace selvage::oracle {

namespace {

__extension__ using Int128 = __int128;
using Integer = boost::multiprecision::cpp_int;

template <typename T>
using Point = std::array<T, 3>;
template <typename T>
using Corners = std::array<Point<T>, 3>;

template <typename T>
Point<T> minus(const Point<T>& a, const Point<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <typename T>
Point<T> opposite(const Point<T>& a) {
  return {-a[0], -a[1], -a[2]};
}
template <typename T>
T dot(const Point<T>& a, const Point<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <typename T>
Point<T> cross(const Point<T>& a, const Point<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <typename T>
bool is_zero(const Point<T>& a) {
  return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

/// Where the origin lies against the hull of some points.
enum class Origin { kOutside, kOnBorder, kInside };

/// Decided by the linear functions that are negative on no point: `edges` has one along each edge of their cone. Their
/// sum is as positive as any can be.
template <typename T>
Origin judge(const std::vector<Point<T>>& points, const std::vector<Point<T>>& candidates) {
  Point<T> sum{0, 0, 0};
  bool any = false;
  for (const Point<T>& c : candidates)
    for (const Point<T>& f : {c, opposite(c)}) {
      if (is_zero(f)) continue;
      if (std::any_of(points.begin(), points.end(), [&](const Point<T>& p) { return dot(f, p) < 0; })) continue;
      any = true;
      for (int k = 0; k < 3; ++k) sum[k] += f[k];
    }
  if (!any) return Origin::kInside;
  const bool apart = std::all_of(points.begin(), points.end(), [&](const Point<T>& p) { return dot(sum, p) > 0; });
  return apart ? Origin::kOutside : Origin::kOnBorder;
}

template <typename T>
TriangleContact contact_of(const Corners<T>& a, const Corners<T>& b) {
  std::vector<Point<T>> points;
  for (const auto& p : a)
    for (const auto& q : b) points.push_back(minus(p, q));
  // How many dimensions the points span, with the origin.
  Point<T> first{0, 0, 0}, normal{0, 0, 0};
  for (const auto& p : points)
    if (is_zero(first)) first = p;
  for (const auto& p : points)
    if (is_zero(normal)) normal = cross(first, p);
  const bool solid = std::any_of(points.begin(), points.end(), [&](const auto& p) { return dot(normal, p) != 0; });
  std::vector<Point<T>> candidates;
  if (solid) {
    for (const auto& p : points)
      for (const auto& q : points) candidates.push_back(cross(p, q));
  } else if (!is_zero(normal)) {
    // In the plane, functions that vanish on a point; seen along an axis, so that numbers stay small.
    int axis = 0;
    while (normal[axis] == 0) ++axis;
    Point<T> up{0, 0, 0};
    up[axis] = 1;
    for (auto& p : points) p[axis] = 0;
    for (const auto& p : points) candidates.push_back(cross(up, p));
  } else {
    candidates.push_back(first);
  }
  switch (judge(points, candidates)) {
    case Origin::kOutside:
      return TriangleContact::kDisjoint;
    case Origin::kOnBorder:
      return TriangleContact::kTouching;
    case Origin::kInside:
      break;
  }
  return solid ? TriangleContact::kCrossing : TriangleContact::kCoplanarOverlap;
}

/// Whether the ray along d, not zero, lies in the cone of u and v.
template <typename T>
bool is_in_cone(const Point<T>& d, const Point<T>& u, const Point<T>& v) {
  const Point<T> n = cross(u, v);
  if (!is_zero(n)) return dot(n, d) == 0 && dot(cross(u, d), n) >= 0 && dot(cross(d, v), n) >= 0;
  for (const auto& ray : {u, v})
    if (is_zero(cross(d, ray)) && dot(d, ray) > 0) return true;
  return false;
}

/// Whether triangles with the common corner 0 meet elsewhere: then their cones share a ray there.
template <typename T>
bool meet_beyond_corner(const Corners<T>& a, const Corners<T>& b) {
  const Point<T> u = minus(a[1], a[0]), v = minus(a[2], a[0]), w = minus(b[1], b[0]), x = minus(b[2], b[0]);
  const Point<T> line = cross(cross(u, v), cross(w, x));
  for (const auto& ray : {u, v, w, x, line, opposite(line)})
    if (!is_zero(ray) && is_in_cone(ray, u, v) && is_in_cone(ray, w, x)) return true;
  return false;
}

/// Whether triangles with the common corners 0 and 1 meet off the edge between them.
template <typename T>
bool meet_beyond_side(const Corners<T>& a, const Corners<T>& b) {
  const Point<T> edge = minus(a[1], a[0]), r = minus(a[2], a[0]), s = minus(b[2], b[0]);
  if (is_zero(edge)) return is_zero(cross(r, s)) && dot(r, s) > 0;
  const Point<T> nr = cross(edge, r), ns = cross(edge, s);
  if (is_zero(nr) && is_zero(ns)) {
    const T length = dot(edge, edge), rr = dot(edge, r), ss = dot(edge, s);
    return (rr > length && ss > length) || (rr < 0 && ss < 0);
  }
  return is_zero(cross(nr, ns)) && dot(nr, ns) > 0;
}

/// Coordinates as integers: all times one power of two.
template <typename T>
std::vector<Point<T>> to_integers(const std::vector<Vec3>& positions, int bits) {
  std::vector<Point<T>> points;
  for (const Vec3& x : positions) {
    Point<T> p;
    for (int k = 0; k < 3; ++k) {
      int exponent = 0;
      const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x[k], &exponent), 53));
      const int shift = exponent - 53 + bits;
      // Below zero, the lowest bits are zeros.
      p[k] = mantissa == 0 ? T(0) : shift >= 0 ? T(mantissa) * (T(1) << shift) : T(mantissa >> -shift);
    }
    points.push_back(p);
  }
  return points;
}

bool boxes_meet(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  for (int k = 0; k < 3; ++k) {
    const auto [a_low, a_high] = std::minmax({a[0][k], a[1][k], a[2][k]});
    const auto [b_low, b_high] = std::minmax({b[0][k], b[1][k], b[2][k]});
    if (a_low > b_high || b_low > a_high) return false;
  }
  return true;
}

template <typename P>
std::array<P, 3> corners_of(const std::vector<P>& points, const VertexTuple<3>& t) {
  return {points[t[0]], points[t[1]], points[t[2]]};
}

/// The vertices of t that u has too come first, in the order of u.
VertexTuple<3> shared_first(const VertexTuple<3>& t, const VertexTuple<3>& u) {
  VertexTuple<3> result{};
  int count = 0;
  for (const Index v : u)
    if (std::find(t.begin(), t.end(), v) != t.end()) result[count++] = v;
  for (const Index v : t)
    if (std::find(u.begin(), u.end(), v) == u.end()) result[count++] = v;
  return result;
}

template <typename T>
std::optional<TriangleContact> judge_pair(const std::vector<Point<T>>& points, const VertexTuple<3>& t,
                                          const VertexTuple<3>& u, bool include_adjacent) {
  const auto shared = std::count_if(t.begin(), t.end(), [&](Index v) { return std::count(u.begin(), u.end(), v); });
  if (shared > 0 && !include_adjacent) return std::nullopt;
  const Corners<T> a = corners_of(points, shared_first(t, u)),
                   b = corners_of(points, shared_first(u, shared_first(t, u)));
  if (shared == 1 && !meet_beyond_corner(a, b)) return std::nullopt;
  if (shared == 2 && !meet_beyond_side(a, b)) return std::nullopt;
  const TriangleContact found = contact_of(a, b);
  return found == TriangleContact::kDisjoint ? std::nullopt : std::optional(found);
}

template <typename T>
std::vector<TrianglePair> all_pairs(const surfaces::Surface& s, bool include_adjacent, int bits) {
  const auto points = to_integers<T>(s.positions, bits);
  std::vector<TrianglePair> pairs;
  const auto count = static_cast<Index>(s.triangles.size());
  for (Index i = 0; i < count; ++i)
    for (Index j = i + 1; j < count; ++j) {
      if (!boxes_meet(corners_of(s.positions, s.triangles[i]), corners_of(s.positions, s.triangles[j]))) continue;
      if (const auto found = judge_pair(points, s.triangles[i], s.triangles[j], include_adjacent))
        pairs.push_back({i, j, *found});
    }
  return pairs;
}

/// The smallest `bits` for which all coordinates times 2^bits are integers, and the size of the largest of these.
struct Fineness {
  int bits = -2000, size = 0;

  explicit Fineness(const std::vector<Vec3>& positions) {
    int top = -2000;
    for (const Vec3& x : positions)
      for (int k = 0; k < 3; ++k) {
        if (x[k] == 0) continue;
        int exponent = 0;
        const auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(x[k], &exponent), 53));
        bits = std::max(bits, 53 - exponent - std::countr_zero(static_cast<std::uint64_t>(mantissa)));
        top = std::max(top, exponent);
      }
    size = top + bits;
  }
};

}  // namespace

std::vector<TrianglePair> meeting_pairs(const surfaces::Surface& surface, bool include_adjacent) {
  const Fineness fine(surface.positions);
  // Sums of up to 162 products of three differences each, or of 24 of seven in the cones of adjacent triangles.
  return (include_adjacent ? 7 : 3) * (fine.size + 1) + 12 < 127
             ? all_pairs<Int128>(surface, include_adjacent, fine.bits)
             : all_pairs<Integer>(surface, include_adjacent, fine.bits);
}

std::vector<TrianglePair> meeting_pairs(const surfaces::Surface& a, const surfaces::Surface& b) {
  const auto first = static_cast<Index>(a.triangles.size());
  auto pairs = meeting_pairs(surfaces::together(a, b), false);
  std::erase_if(pairs, [&](const TrianglePair& p) { return p.first >= first || p.second < first; });
  for (TrianglePair& pair : pairs) pair.second -= first;
  return pairs;
}

TriangleContact contact(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  std::vector<Vec3> positions(a.begin(), a.end());
  positions.insert(positions.end(), b.begin(), b.end());
  const auto points = to_integers<Integer>(positions, Fineness(positions).bits);
  return contact_of<Integer>({points[0], points[1], points[2]}, {points[3], points[4], points[5]});
}

}  // namespace selvage::oracle
