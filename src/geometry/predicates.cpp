#include "selvage/geometry/predicates.h"

#include "geometry/exact/exact_orientation.h"
#include "geometry/orientation_filter.h"

namespace selvage {

namespace {

/// Equal points are the commonest flat simplices (a ray through a vertex, a point at a vertex) and the cheapest to see.
template <class Points>
bool has_equal_points(const Points& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if (points[i] == points[j]) return true;
  return false;
}

}  // namespace

namespace detail {

int orient2d_exact(const Vec2& a, const Vec2& b, const Vec2& c) {
  const std::array<Vec2, 3> points{a, b, c};
  if (has_equal_points(points)) return 0;
  return expansions_are_exact<2, 3>(points) ? orient2d_by_expansions(points) : orient2d_by_integers(points);
}

int orient3d_exact(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> points{a, b, c, d};
  if (has_equal_points(points)) return 0;
  return expansions_are_exact<3, 4>(points) ? orient3d_by_expansions(points) : orient3d_by_integers(points);
}

}  // namespace detail

int orient2d(const Vec2& a, const Vec2& b, const Vec2& c) {
  const int sign = detail::filter_sign_of_det(b - a, c - a);
  return sign != 0 ? sign : detail::orient2d_exact(a, b, c);
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const int sign = detail::filter_sign_of_det(u, detail::cross_with_bound(v, w));
  return sign != 0 ? sign : detail::orient3d_exact(a, b, c, d);
}

int orientation(const std::array<Vec2, 3>& simplex) {
  return orient2d(simplex[0], simplex[1], simplex[2]);
}

int orientation(const std::array<Vec3, 4>& simplex) {
  return orient3d(simplex[0], simplex[1], simplex[2], simplex[3]);
}

namespace {

/// Signs, as far as the filter knows them, of the simplex with vertex i replaced by p; 0: not known.
std::array<int, 3> filter_coordinate_signs(const std::array<Vec2, 3>& simplex, const Vec2& p) {
  const Vec2 a = simplex[0] - p, b = simplex[1] - p, c = simplex[2] - p;
  return {detail::filter_sign_of_det(b, c), detail::filter_sign_of_det(c, a), detail::filter_sign_of_det(a, b)};
}

/// Two cross products serve all four determinants.
std::array<int, 4> filter_coordinate_signs(const std::array<Vec3, 4>& simplex, const Vec3& p) {
  const Vec3 a = simplex[0] - p, b = simplex[1] - p, c = simplex[2] - p, d = simplex[3] - p;
  const detail::BoundedCross cd = detail::cross_with_bound(c, d);
  const detail::BoundedCross ab = detail::cross_with_bound(a, b);
  return {detail::filter_sign_of_det(b, cd), -detail::filter_sign_of_det(a, cd), detail::filter_sign_of_det(d, ab),
          -detail::filter_sign_of_det(c, ab)};
}

template <int D>
int exact_coordinate_sign(std::array<Vec<D>, D + 1> simplex, const Vec<D>& p, int i) {
  simplex[i] = p;
  if constexpr (D == 2)
    return detail::orient2d_exact(simplex[0], simplex[1], simplex[2]);
  else
    return detail::orient3d_exact(simplex[0], simplex[1], simplex[2], simplex[3]);
}

}  // namespace

template <int D>
Containment locate_in_simplex(const std::array<Vec<D>, D + 1>& simplex, const Vec<D>& p) {
  // The signed volumes of the simplex with one vertex replaced by p add up to its own: p is inside when no two of them
  // differ in sign, and the simplex is flat when moreover all are zero. Its own sign is never needed.
  std::array<int, D + 1> signs = filter_coordinate_signs(simplex, p);
  bool any_positive = false, any_negative = false;
  for (int sign : signs) {
    any_positive |= sign > 0;
    any_negative |= sign < 0;
  }
  Containment result;
  for (int i = 0; i <= D && !(any_positive && any_negative); ++i) {
    if (signs[i] != 0) continue;
    signs[i] = exact_coordinate_sign<D>(simplex, p, i);
    any_positive |= signs[i] > 0;
    any_negative |= signs[i] < 0;
    if (signs[i] == 0) result.zero_mask |= 1u << i;
  }
  result.inside = any_positive != any_negative;
  if (!result.inside) result.zero_mask = 0;
  return result;
}

template Containment locate_in_simplex<2>(const std::array<Vec2, 3>&, const Vec2&);
template Containment locate_in_simplex<3>(const std::array<Vec3, 4>&, const Vec3&);

}  // namespace selvage
