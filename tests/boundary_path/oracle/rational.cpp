#include "boundary_path/oracle/rational.h"

namespace selvage::oracle {

namespace {

template <int D>
RationalVec<D> mix(const RationalVec<D>& a, const Rational& s, const RationalVec<D>& b, const Rational& t,
                   const RationalVec<D>& c) {
  RationalVec<D> result;
  for (int i = 0; i < D; ++i) result[i] = a[i] + s * b[i] + t * c[i];
  return result;
}

// Foot of the perpendicular from the origin on the segment's line, where it falls strictly inside the segment.
template <int D>
std::optional<RationalVec<D>> foot_on_edge(const RationalVec<D>& a, const RationalVec<D>& b) {
  const RationalVec<D> e = b - a;
  const Rational length = dot(e, e);
  if (length == 0) return std::nullopt;
  const Rational s = -dot(a, e) / length;
  if (s <= 0 || s >= 1) return std::nullopt;
  return mix<D>(a, s, e, 0, e);
}

std::optional<RationalVec<3>> foot_on_triangle(const RationalVec<3>& a, const RationalVec<3>& b,
                                               const RationalVec<3>& c) {
  const RationalVec<3> e = b - a, g = c - a;
  const Rational ee = dot(e, e), eg = dot(e, g), gg = dot(g, g), det = ee * gg - eg * eg;
  if (det == 0) return std::nullopt;
  const Rational ae = -dot(a, e), ag = -dot(a, g);
  const Rational s = (ae * gg - ag * eg) / det, t = (ag * ee - ae * eg) / det;
  if (s <= 0 || t <= 0 || s + t >= 1) return std::nullopt;
  return mix<3>(a, s, e, t, g);
}

// Two linear functions (one in the plane) whose common zeros are the multiples of the direction.
std::array<RationalVec<2>, 1> functions_vanishing_on(const RationalVec<2>& d) {
  return {RationalVec<2>{-d[1], d[0]}};
}

std::array<RationalVec<3>, 2> functions_vanishing_on(const RationalVec<3>& d) {
  int k = 0;
  while (d[k] == 0) ++k;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  std::array<RationalVec<3>, 2> result{};
  result[0][i] = d[k];
  result[0][k] = -d[i];
  result[1][j] = d[k];
  result[1][k] = -d[j];
  return result;
}

// Collects the parameters at the corners of the set of solutions.
struct ParameterRange {
  std::optional<std::pair<Rational, Rational>> range;
  void add(const Rational& u) {
    if (!range) range = {u, u};
    if (u < range->first) range->first = u;
    if (u > range->second) range->second = u;
  }
};

}  // namespace

template <int D>
RationalVec<D> closest_to_origin(const std::array<RationalVec<D>, D>& face) {
  std::optional<RationalVec<D>> best;
  auto offer = [&](const std::optional<RationalVec<D>>& x) {
    if (x && (!best || dot(*x, *x) < dot(*best, *best))) best = x;
  };
  for (int i = 0; i < D; ++i) {
    offer(face[i]);
    for (int j = i + 1; j < D; ++j) offer(foot_on_edge<D>(face[i], face[j]));
  }
  if constexpr (D == 3) offer(foot_on_triangle(face[0], face[1], face[2]));
  return *best;
}

template <int D>
std::optional<std::pair<Rational, Rational>> meet_line(const std::array<RationalVec<D>, D>& face,
                                                       const RationalVec<D>& direction) {
  const auto functions = functions_vanishing_on(direction);
  const Rational squared = dot(direction, direction);
  std::array<RationalVec<D - 1>, D> flat;  // the face seen along the line
  std::array<Rational, D> along;           // the parameter of each vertex's foot on the line
  for (int i = 0; i < D; ++i) {
    for (int k = 0; k < D - 1; ++k) flat[i][k] = dot(functions[k], face[i]);
    along[i] = dot(face[i], direction) / squared;
  }
  // The points of the face that lie on the line form a polytope; its corners use as few vertices as possible.
  ParameterRange corners;
  for (int i = 0; i < D; ++i) {
    if (dot(flat[i], flat[i]) == 0) corners.add(along[i]);
    for (int j = i + 1; j < D; ++j) {
      if constexpr (D == 3) {
        if (determinant(flat[i], flat[j]) != 0) continue;
      }
      if (dot(flat[i], flat[j]) >= 0) continue;
      const RationalVec<D - 1> e = flat[j] - flat[i];
      const Rational s = -dot(flat[i], e) / dot(e, e);
      corners.add(along[i] + s * (along[j] - along[i]));
    }
  }
  if constexpr (D == 3) {
    const Rational a = determinant(flat[1], flat[2]), b = determinant(flat[2], flat[0]),
                   c = determinant(flat[0], flat[1]), sum = a + b + c;
    const bool inside = (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
    if (inside) corners.add((a * along[0] + b * along[1] + c * along[2]) / sum);
  }
  return corners.range;
}

template RationalVec<2> closest_to_origin<2>(const std::array<RationalVec<2>, 2>&);
template RationalVec<3> closest_to_origin<3>(const std::array<RationalVec<3>, 3>&);
template std::optional<std::pair<Rational, Rational>> meet_line<2>(const std::array<RationalVec<2>, 2>&,
                                                                   const RationalVec<2>&);
template std::optional<std::pair<Rational, Rational>> meet_line<3>(const std::array<RationalVec<3>, 3>&,
                                                                   const RationalVec<3>&);

}  // namespace selvage::oracle
