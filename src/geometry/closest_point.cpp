#include "selvage/geometry/closest_point.h"

#include "geometry/orientation_filter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/exact/exact_integer.h"
#include "selvage/geometry/predicates.h"

namespace selvage {

namespace {

// Squared lengths in this range keep all products below from over- and underflowing; other inputs are scaled first.
// (Volumes in this range have lost nothing either.)
constexpr double kSmallestSafe = 0x1p-200, kLargestSafe = 0x1p200;

bool in_safe_range(double value) {
  return value >= kSmallestSafe && value <= kLargestSafe;
}

template <int D, int N>
ClosestPoint<D, N> closest_vertex(const Vec<D>& p, const Vec<D>& vertex, int i) {
  ClosestPoint<D, N> result;
  result.point = vertex;
  result.squared_distance = (p - vertex).squaredNorm();
  result.barycentric[i] = 1;
  result.vertex_mask = 1u << i;
  return result;
}

/// The closest point of the segment from vertex i to vertex j of a simplex of N vertices. The same bits for (i, j) and
/// (j, i), so that both faces at an edge find the same distance: all is computed from the nearer end.
template <int D, int N>
ClosestPoint<D, N> closest_on_edge(const Vec<D>& p, const std::array<Vec<D>, N>& vertices, int i, int j) {
  const Vec<D>&a = vertices[i], &b = vertices[j];
  const Vec<D> edge = b - a;
  const double from_a = edge.dot(p - a), from_b = edge.dot(b - p), total = from_a + from_b;
  if (!(from_a > 0)) return closest_vertex<D, N>(p, a, i);
  if (!(from_b > 0)) return closest_vertex<D, N>(p, b, j);
  const double small = std::min(from_a, from_b) / total;
  if (!(small > 0)) return from_a < from_b ? closest_vertex<D, N>(p, a, i) : closest_vertex<D, N>(p, b, j);
  ClosestPoint<D, N> result;
  const double large = 1 - small;
  if (from_a == from_b)
    result.point = 0.5 * a + 0.5 * b;
  else
    result.point = from_a < from_b ? Vec<D>(a + small * edge) : Vec<D>(b - small * edge);
  result.barycentric[i] = from_a < from_b ? large : small;
  result.barycentric[j] = from_a < from_b ? small : large;
  result.squared_distance = (p - result.point).squaredNorm();
  result.vertex_mask = 1u << i | 1u << j;
  return result;
}

template <class Result>
void keep_closer(Result& best, const Result& candidate) {
  if (candidate.squared_distance < best.squared_distance) best = candidate;
}

using Triangle = std::array<Vec3, 3>;

ClosestPoint<3, 3> closest_on_edges(const Vec3& p, const Triangle& triangle) {
  ClosestPoint<3, 3> best = closest_on_edge<3, 3>(p, triangle, 0, 1);
  keep_closer(best, closest_on_edge<3, 3>(p, triangle, 1, 2));
  keep_closer(best, closest_on_edge<3, 3>(p, triangle, 2, 0));
  return best;
}

/// Three points are on one line when they are so in all three coordinate planes.
bool is_exactly_flat(const Triangle& triangle) {
  for (int k = 0; k < 3; ++k) {
    const int x = k, y = (k + 1) % 3;
    std::array<Vec2, 3> projection;
    for (int i = 0; i < 3; ++i) projection[i] = Vec2(triangle[i][x], triangle[i][y]);
    if (orientation(projection) != 0) return false;
  }
  return true;
}

/// For a needle or a sliver. Its longest edge gives a well-conditioned axis: the place along the edge is computed by
/// itself, and an error in the weight of the apex, however large, moves the point only across the thin triangle.
/// Whether the foot of the perpendicular is inside may be misjudged by rounding, so the edges are always candidates
/// too.
ClosestPoint<3, 3> closest_on_thin_triangle(const Vec3& p, const Triangle& triangle) {
  ClosestPoint<3, 3> best = closest_on_edges(p, triangle);
  if (is_exactly_flat(triangle)) return best;
  int apex = 0;
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double length = (triangle[(i + 2) % 3] - triangle[(i + 1) % 3]).squaredNorm();
    if (length > longest) {
      longest = length;
      apex = i;
    }
  }
  const int i = (apex + 1) % 3, j = (apex + 2) % 3;
  const Vec3 edge = triangle[j] - triangle[i], side = triangle[apex] - triangle[i], to_p = p - triangle[i];
  const Vec3 normal = edge.cross(side);
  const double squared_normal = normal.squaredNorm();
  if (!(squared_normal > 0)) return best;
  const double apex_weight = normal.dot(edge.cross(to_p)) / squared_normal;
  const double j_weight = edge.dot(to_p) / longest - apex_weight * (edge.dot(side) / longest);
  const double i_weight = 1 - apex_weight - j_weight;
  // These two are differences. What is left of one that is zero is rounding, and an edge is as close.
  constexpr double kRounding = 0x1p-50;
  if (!(apex_weight > 0 && j_weight > kRounding && i_weight > kRounding)) return best;
  ClosestPoint<3, 3> foot;
  foot.point = triangle[i] + j_weight * edge + apex_weight * side;
  foot.squared_distance = (p - foot.point).squaredNorm();
  foot.barycentric[apex] = apex_weight;
  foot.barycentric[i] = i_weight;
  foot.barycentric[j] = j_weight;
  foot.vertex_mask = 7;
  keep_closer(best, foot);
  return best;
}

/// For coordinates whose squares neither over- nor underflow.
ClosestPoint<3, 3> closest_on_triangle(const Vec3& p, const Triangle& triangle) {
  // Products of cross products rather than of dot products: these lose the sine of the angle, those its square.
  const Vec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0], w = p - triangle[0];
  const Vec3 normal = u.cross(v);
  const double squared_normal = normal.squaredNorm();
  // An angle below 6 degrees, or above 174, at vertex 0: the weights would lose more than a digit.
  constexpr double kThinSquaredSine = 0.01;
  // Far above what products lose by underflow, and far below any ordinary triangle in the safe range.
  constexpr double kSmallestSquaredNormal = 0x1p-500;
  if (!(squared_normal > std::max(kThinSquaredSine * u.squaredNorm() * v.squaredNorm(), kSmallestSquaredNormal)))
    return closest_on_thin_triangle(p, triangle);
  const double weight1 = normal.dot(w.cross(v)), weight2 = normal.dot(u.cross(w));
  const double weight0 = squared_normal - weight1 - weight2;
  if (weight0 > 0 && weight1 > 0 && weight2 > 0) {
    ClosestPoint<3, 3> result;
    result.barycentric = {weight0 / squared_normal, weight1 / squared_normal, weight2 / squared_normal};
    result.point = triangle[0] + result.barycentric[1] * u + result.barycentric[2] * v;
    result.squared_distance = (p - result.point).squaredNorm();
    result.vertex_mask = 7;
    return result;
  }
  // The closest point is on an edge whose outer side the foot of the perpendicular sees.
  ClosestPoint<3, 3> best;
  best.squared_distance = std::numeric_limits<double>::infinity();
  if (!(weight0 > 0)) best = closest_on_edge<3, 3>(p, triangle, 1, 2);
  if (!(weight1 > 0)) keep_closer(best, closest_on_edge<3, 3>(p, triangle, 2, 0));
  if (!(weight2 > 0)) keep_closer(best, closest_on_edge<3, 3>(p, triangle, 0, 1));
  return best;
}

using Tetrahedron = std::array<Vec3, 4>;

/// Barycentric coordinates of an inner point, by exact volumes, so that they are right in the thinnest of tetrahedra.
std::array<double, 4> exact_barycentric(const Vec3& p, const Tetrahedron& simplex) {
  using boost::multiprecision::cpp_int;
  using boost::multiprecision::cpp_rational;
  std::array<double, 15> values;
  for (int i = 0; i < 5; ++i)
    for (int k = 0; k < 3; ++k) values[3 * i + k] = i < 4 ? simplex[i][k] : p[k];
  std::array<ExactInt, 15> integers;
  to_common_integers(values, integers);
  const auto difference = [&](int i, int k) { return integers[3 * i + k] - integers[12 + k]; };
  std::array<ExactInt, 4> volumes;
  ExactInt total = 0;
  for (int i = 0; i < 4; ++i) {
    const int r = (i + 1) % 4, s = (i + 2) % 4, t = (i + 3) % 4;
    ExactInt volume = 0;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      volume += difference(r, k) * (difference(s, l) * difference(t, m) - difference(s, m) * difference(t, l));
    }
    volumes[i] = abs(volume);
    total += volumes[i];
  }
  std::array<double, 4> barycentric;
  for (int i = 0; i < 4; ++i)
    barycentric[i] = cpp_rational(cpp_int(volumes[i]), cpp_int(total)).template convert_to<double>();
  return barycentric;
}

std::array<double, 4> barycentric_inside(const Vec3& p, const Tetrahedron& simplex, unsigned zero_mask) {
  std::array<double, 4> weights{};
  double total = 0, terms = 0;
  for (int i = 0; i < 4; ++i) {
    if ((zero_mask >> i & 1) != 0) continue;
    const Vec3 u = simplex[(i + 1) % 4] - p, v = simplex[(i + 2) % 4] - p, w = simplex[(i + 3) % 4] - p;
    const detail::BoundedCross cross = detail::cross_with_bound(v, w);
    weights[i] = std::abs(u[0] * cross.value[0] + u[1] * cross.value[1] + u[2] * cross.value[2]);
    terms += std::abs(u[0]) * cross.bound[0] + std::abs(u[1]) * cross.bound[1] + std::abs(u[2]) * cross.bound[2];
    total += weights[i];
    if (!(weights[i] > 0)) return exact_barycentric(p, simplex);
  }
  // How many times larger than the volumes their terms may be: what cancels is lost from the weights.
  constexpr double kLargestLoss = 16;
  if (!(in_safe_range(total) && terms <= kLargestLoss * total)) return exact_barycentric(p, simplex);
  for (double& weight : weights) weight /= total;
  return weights;
}

/// For coordinates whose squares neither over- nor underflow.
ClosestPoint<3, 4> closest_on_boundary(const Vec3& p, const Tetrahedron& simplex) {
  ClosestPoint<3, 4> best = closest_vertex<3, 4>(p, simplex[0], 0);
  for (int face = 0; face < 4; ++face) {
    const std::array<int, 3> corners{(face + 1) % 4, (face + 2) % 4, (face + 3) % 4};
    const auto found = closest_on_triangle(p, {simplex[corners[0]], simplex[corners[1]], simplex[corners[2]]});
    if (!(found.squared_distance < best.squared_distance)) continue;
    best.barycentric.fill(0);
    best.vertex_mask = 0;
    best.point = found.point;
    best.squared_distance = found.squared_distance;
    for (int i = 0; i < 3; ++i) {
      best.barycentric[corners[i]] = found.barycentric[i];
      best.vertex_mask |= (found.vertex_mask >> i & 1u) << corners[i];
    }
  }
  return best;
}

/// Solves where squares neither over- nor underflow: as it is when the points allow it, else all points divided by one
/// power of two, and the answer brought back.
template <int D, int N, class Solve>
ClosestPoint<D, N> solve_in_safe_range(const Vec<D>& p, const std::array<Vec<D>, N>& vertices, Solve&& solve) {
  double squares = (p - vertices[0]).squaredNorm();
  for (int i = 1; i < N; ++i) squares += (vertices[i] - vertices[0]).squaredNorm();
  if (in_safe_range(squares)) return solve(p, vertices);
  double largest = p.cwiseAbs().maxCoeff();
  for (const Vec<D>& vertex : vertices) largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
  if (largest == 0) return closest_vertex<D, N>(p, vertices[0], 0);
  const int exponent = std::ilogb(largest);
  const auto scale = [](const Vec<D>& x, int by) {
    return Vec<D>(x.unaryExpr([by](double c) { return std::ldexp(c, by); }));
  };
  std::array<Vec<D>, N> scaled;
  for (int i = 0; i < N; ++i) scaled[i] = scale(vertices[i], -exponent);
  ClosestPoint<D, N> result = solve(scale(p, -exponent), scaled);
  result.point = scale(result.point, exponent);
  result.squared_distance = std::ldexp(result.squared_distance, 2 * exponent);
  for (int i = 0; i < N; ++i)
    if (result.vertex_mask == 1u << i) result.point = vertices[i];
  return result;
}

}  // namespace

template <int D>
ClosestPoint<D, 2> closest_point_on_segment(const Vec<D>& p, const Vec<D>& a, const Vec<D>& b) {
  return solve_in_safe_range<D, 2>(p, {a, b}, [](const Vec<D>& q, const std::array<Vec<D>, 2>& ends) {
    return closest_on_edge<D, 2>(q, ends, 0, 1);
  });
}

template ClosestPoint<2, 2> closest_point_on_segment<2>(const Vec2&, const Vec2&, const Vec2&);
template ClosestPoint<3, 2> closest_point_on_segment<3>(const Vec3&, const Vec3&, const Vec3&);

ClosestPoint<3, 3> closest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return solve_in_safe_range<3, 3>(p, {a, b, c}, closest_on_triangle);
}

ClosestPoint<3, 4> closest_point_on_tetrahedron(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c,
                                                const Vec3& d) {
  const Tetrahedron simplex{a, b, c, d};
  const Containment containment = locate_in_simplex<3>(simplex, p);
  if (!containment.inside) return solve_in_safe_range<3, 4>(p, simplex, closest_on_boundary);
  ClosestPoint<3, 4> result;
  result.point = p;
  result.barycentric = barycentric_inside(p, simplex, containment.zero_mask);
  result.vertex_mask = 15u & ~containment.zero_mask;
  return result;
}

}  // namespace selvage
