#include "boundary_path/traversal/exact_segment.h"

#include "boundary_path/traversal/double_double_segment.h"
#include "geometry/exact/exact_integer.h"
#include "selvage/geometry/predicates.h"

#include <cmath>

namespace selvage {

namespace {

template <int D>
using IntVec = std::array<ExactInt, D>;

template <int D>
ExactInt dot(const IntVec<D>& a, const IntVec<D>& b) {
  ExactInt sum = a[0] * b[0] + a[1] * b[1];
  if constexpr (D == 3) sum += a[2] * b[2];
  return sum;
}

template <int D>
IntVec<D> minus(const IntVec<D>& a, const IntVec<D>& b) {
  IntVec<D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] - b[i];
  return r;
}

template <int D>
IntVec<D> times(const IntVec<D>& a, const ExactInt& k) {
  IntVec<D> r;
  for (int i = 0; i < D; ++i) r[i] = a[i] * k;
  return r;
}

IntVec<3> cross(const IntVec<3>& a, const IntVec<3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

ExactInt cross(const IntVec<2>& a, const IntVec<2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// The points relative to p, all scaled to integers by one power of two.
template <int D, std::size_t N>
std::array<IntVec<D>, N> relative_integers(const Vec<D>& p, const std::array<Vec<D>, N>& points) {
  std::array<double, (N + 1) * D> values;
  for (int i = 0; i < D; ++i) values[i] = p[i];
  for (std::size_t k = 0; k < N; ++k)
    for (int i = 0; i < D; ++i) values[(k + 1) * D + i] = points[k][i];
  std::array<ExactInt, (N + 1) * D> integers;
  to_common_integers(values, integers);
  std::array<IntVec<D>, N> relative;
  for (std::size_t k = 0; k < N; ++k)
    for (int i = 0; i < D; ++i) relative[k][i] = integers[(k + 1) * D + i] - integers[i];
  return relative;
}

/// s - p = numerator / denominator, with a positive denominator.
template <int D>
struct Offset {
  IntVec<D> numerator;
  ExactInt denominator = 1;
};

template <int D>
Offset<D> offset_to(int count, const IntVec<D>* v) {
  if (count == 1) return {v[0], 1};
  if (count == 2) {
    const IntVec<D> e = minus<D>(v[1], v[0]);
    const ExactInt squared = dot<D>(e, e);
    if (squared == 0) return {v[0], 1};
    return {minus<D>(times<D>(v[0], squared), times<D>(e, dot<D>(v[0], e))), squared};
  }
  if constexpr (D == 3) {
    const IntVec<3> n = cross(minus<3>(v[1], v[0]), minus<3>(v[2], v[0]));
    const ExactInt squared = dot<3>(n, n);
    if (squared != 0) return {times<3>(n, dot<3>(n, v[0])), squared};
  }
  return {v[0], 1};
}

/// Normal of a face such that orientation(face, x) = normal . (x - face[0]).
IntVec<3> integer_normal(const std::array<IntVec<3>, 3>& f) {
  return cross(minus<3>(f[1], f[0]), minus<3>(f[2], f[0]));
}
IntVec<2> integer_normal(const std::array<IntVec<2>, 2>& f) {
  const IntVec<2> e = minus<2>(f[1], f[0]);
  return {-e[1], e[0]};
}

/// A stretch of the line through p and s: parameters, 0 at p and 1 at s.
struct Stretch {
  int first, last;
};
constexpr Stretch kSegment{0, 1}, kReach{-1, 3};

/// The segment and a face as integers relative to p.
template <int D>
struct SegmentAndFace {
  Offset<D> offset;
  std::array<IntVec<D>, D> face;
  IntVec<D> normal;
  ExactInt height;  ///< normal . face[0]: minus the orientation of (face, p)
  ExactInt slope;   ///< normal . offset numerator

  SegmentAndFace(const Vec<D>& p, const TargetSimplex<D>& target, const FacePoints<D>& points) {
    std::array<Vec<D>, 2 * D> all;
    for (int i = 0; i < D; ++i) {
      all[i] = i < target.count ? target.vertices[i] : p;
      all[D + i] = points[i];
    }
    const auto relative = relative_integers<D>(p, all);
    offset = offset_to<D>(target.count, relative.data());
    for (int i = 0; i < D; ++i) face[i] = relative[D + i];
    normal = integer_normal(face);
    height = dot<D>(normal, face[0]);
    slope = dot<D>(normal, offset.numerator);
  }

  int start() const { return -sign_of(height); }
  int end() const { return sign_of(ExactInt(slope - offset.denominator * height)); }
  bool line_in_plane() const { return height == 0 && slope == 0; }

  /// Whether the stretch meets the plane of the face: at the parameter denominator * height / slope, or everywhere.
  bool crosses_plane_in(Stretch stretch) const {
    const int sign = slope < 0 ? -1 : 1;
    const ExactInt crossing = offset.denominator * height * sign, unit = slope * sign;
    return unit * stretch.first <= crossing && crossing <= unit * stretch.last;
  }
};

int side_of(const IntVec<2>& d, const IntVec<2>& a) {
  return sign_of(cross(d, a));
}
int side_of(const IntVec<3>& d, const IntVec<3>& a, const IntVec<3>& b) {
  return sign_of(dot<3>(d, cross(a, b)));
}

/// Whether a line that crosses the plane of the face passes through the closed face.
bool passes_through(const SegmentAndFace<2>& s) {
  const IntVec<2>& d = s.offset.numerator;
  return side_of(d, s.face[0]) * side_of(d, s.face[1]) <= 0;
}
bool passes_through(const SegmentAndFace<3>& s) {
  const IntVec<3>& d = s.offset.numerator;
  bool positive = false, negative = false;
  for (int i = 0; i < 3; ++i) {
    const int side = side_of(d, s.face[i], s.face[(i + 1) % 3]);
    positive |= side > 0;
    negative |= side < 0;
  }
  return !(positive && negative);
}

/// Whether a stretch of the line meets a face that lies on the line.
template <int D>
bool overlaps_on_line(const SegmentAndFace<D>& s, Stretch stretch) {
  const IntVec<D>& d = s.offset.numerator;
  const ExactInt unit = dot<D>(d, d);
  bool behind = false, ahead = false;
  for (const auto& v : s.face) {
    const ExactInt at = s.offset.denominator * dot<D>(d, v);
    behind |= at <= unit * stretch.last;
    ahead |= at >= unit * stretch.first;
  }
  return behind && ahead;
}

/// Whether a stretch of the line meets an edge with which it is in line; one without length may lie beside it.
bool overlaps_in_plane(const SegmentAndFace<2>& s, Stretch stretch) {
  return side_of(s.offset.numerator, s.face[0]) == 0 && overlaps_on_line(s, stretch);
}

/// Whether a stretch of the line meets a triangle in whose plane the line lies: separating axes in the projection along
/// one coordinate. A flat triangle has no plane of its own, but one with the line.
bool overlaps_in_plane(const SegmentAndFace<3>& s, Stretch stretch) {
  const auto is_zero = [](const IntVec<3>& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; };
  IntVec<3> normal = s.normal;
  for (const auto& v : s.face)
    if (is_zero(normal)) normal = cross(s.offset.numerator, v);
  if (is_zero(normal)) return overlaps_on_line(s, stretch);
  for (const auto& v : s.face)
    if (dot<3>(normal, minus<3>(v, s.face[0])) != 0) return false;

  int drop = 0;
  while (normal[drop] == 0) ++drop;
  const auto flat = [&](const IntVec<3>& v) { return IntVec<2>{v[(drop + 1) % 3], v[(drop + 2) % 3]}; };
  const IntVec<2> d = flat(s.offset.numerator);
  std::array<IntVec<2>, 3> t;
  for (int i = 0; i < 3; ++i) t[i] = times<2>(flat(s.face[i]), s.offset.denominator);
  int left = 0, right = 0;
  for (const auto& v : t) {
    left += side_of(d, v) > 0;
    right += side_of(d, v) < 0;
  }
  if (left == 3 || right == 3) return false;
  const IntVec<2> from = times<2>(d, stretch.first), to = times<2>(d, stretch.last);
  for (int i = 0; i < 3; ++i) {
    const IntVec<2>&a = t[i], &b = t[(i + 1) % 3], &c = t[(i + 2) % 3];
    const IntVec<2> e = minus<2>(b, a);
    const int first = side_of(e, minus<2>(from, a)), last = side_of(e, minus<2>(to, a));
    const int inside = side_of(e, minus<2>(c, a));
    if (first * last > 0 && first * inside <= 0) return false;
  }
  return true;
}

}  // namespace

template <int D>
int ExactSegment<D>::side(const std::array<Vec<D>, D - 1>& points) const {
  if constexpr (D == 3)
    if (const int sign = double_double::side(p_, target_, points); sign != 0) return sign;
  std::array<Vec<D>, 2 * D - 1> all;
  for (int i = 0; i < D; ++i) all[i] = i < target_.count ? target_.vertices[i] : p_;
  for (int i = 0; i < D - 1; ++i) all[D + i] = points[i];
  const auto relative = relative_integers<D>(p_, all);
  const IntVec<D> d = offset_to<D>(target_.count, relative.data()).numerator;
  if constexpr (D == 2)
    return side_of(d, relative[D]);
  else
    return side_of(d, relative[D], relative[D + 1]);
}

template <int D>
int ExactSegment<D>::side_of_start(const FacePoints<D>& face) const {
  return SegmentAndFace<D>(p_, target_, face).start();
}

template <int D>
int ExactSegment<D>::side_of_end(const FacePoints<D>& face) const {
  return SegmentAndFace<D>(p_, target_, face).end();
}

template <int D>
bool ExactSegment<D>::touches(const FacePoints<D>& face) const {
  if constexpr (D == 3) {
    // Mostly the segment clearly crosses the plane or clearly does not, and what is to be decided is a side.
    const int start = orientation({face[0], face[1], face[2], p_}), end = double_double::side_of_end(p_, target_, face);
    if (start * end > 0) return false;
    if (start * end < 0) {
      bool positive = false, negative = false;
      for (int i = 0; i < 3; ++i) {
        const int sign = side({face[i], face[(i + 1) % 3]});
        positive |= sign > 0;
        negative |= sign < 0;
      }
      return !(positive && negative);
    }
  }
  const SegmentAndFace<D> s(p_, target_, face);
  const int start = s.start(), end = s.end();
  if (start * end > 0) return false;
  return start == 0 && end == 0 ? overlaps_in_plane(s, kSegment) : passes_through(s);
}

template <int D>
bool ExactSegment<D>::touches_within_reach(const FacePoints<D>& face) const {
  const SegmentAndFace<D> s(p_, target_, face);
  if (s.line_in_plane()) return overlaps_in_plane(s, kReach);
  return s.slope != 0 && passes_through(s) && s.crosses_plane_in(kReach);
}

template <int D>
bool ExactSegment<D>::crosses_within_reach(const FacePoints<D>& face) const {
  return SegmentAndFace<D>(p_, target_, face).crosses_plane_in(kReach);
}

template class ExactSegment<2>;
template class ExactSegment<3>;

unsigned exact_closest_mask(const Vec2& p, const std::array<Vec2, 2>& face) {
  const auto v = relative_integers<2>(p, face);
  const IntVec<2> e = minus<2>(v[1], v[0]);
  if (dot<2>(v[0], e) >= 0) return 0b01;
  if (dot<2>(v[1], e) <= 0) return 0b10;
  return 0b11;
}

unsigned exact_closest_mask(const Vec3& p, const std::array<Vec3, 3>& face) {
  const auto v = relative_integers<3>(p, face);
  std::array<IntVec<3>, 3> e;  // edge i is opposite to vertex i
  for (int i = 0; i < 3; ++i) e[i] = minus<3>(v[(i + 2) % 3], v[(i + 1) % 3]);
  // Moving from vertex i along either of its edges must not come closer.
  for (int i = 0; i < 3; ++i)
    if (dot<3>(v[i], e[(i + 2) % 3]) >= 0 && dot<3>(v[i], e[(i + 1) % 3]) <= 0) return 1u << i;
  const IntVec<3> n = cross(e[2], minus<3>(v[2], v[0]));
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    const bool between = dot<3>(v[a], e[i]) < 0 && dot<3>(v[b], e[i]) > 0;  // never so on an edge without length
    // p lies beyond edge (a, b) or above it: det(n, b - a, p - a) >= 0 means the inner side.
    if (between && dot<3>(v[a], cross(n, e[i])) >= 0) return (1u << a) | (1u << b);
  }
  return 0b111;
}

namespace {

/// numerator / denominator * 2^exponent, correct to one unit in the last place; the denominator is positive.
double quotient(const ExactInt& numerator, const ExactInt& denominator, int exponent) {
  if (numerator == 0) return 0;
  const ExactInt magnitude = abs(numerator);
  const int shift = 64 + static_cast<int>(msb(denominator)) - static_cast<int>(msb(magnitude));
  const ExactInt q =
      shift >= 0 ? ExactInt((magnitude << shift) / denominator) : ExactInt(magnitude / (denominator << -shift));
  const double value = std::ldexp(q.convert_to<double>(), exponent - shift);
  return numerator < 0 ? -value : value;
}

template <int D>
PreciseOffset<D> exact_offset(const Vec<D>& p, const TargetSimplex<D>& target) {
  std::array<double, (D + 1) * D> values;
  for (int i = 0; i < D; ++i) {
    values[i] = p[i];
    for (int k = 0; k < D; ++k) values[(k + 1) * D + i] = k < target.count ? target.vertices[k][i] : p[i];
  }
  std::array<ExactInt, (D + 1) * D> integers;
  const int exponent = to_common_integers(values, integers);
  std::array<IntVec<D>, D> v;
  for (int k = 0; k < D; ++k)
    for (int i = 0; i < D; ++i) v[k][i] = integers[(k + 1) * D + i] - integers[i];

  const Offset<D> offset = offset_to<D>(target.count, v.data());
  PreciseOffset<D> result;
  for (int i = 0; i < D; ++i) result.offset[i] = quotient(offset.numerator[i], offset.denominator, exponent);
  result.barycentric[0] = 1;
  if (target.count == 2) {
    const IntVec<D> e = minus<D>(v[1], v[0]);
    result.barycentric[1] = quotient(-dot<D>(v[0], e), offset.denominator, 0);
    result.barycentric[0] = quotient(dot<D>(v[1], e), offset.denominator, 0);
  }
  if constexpr (D == 3) {
    if (target.count == 3) {
      const IntVec<3> n = cross(minus<3>(v[1], v[0]), minus<3>(v[2], v[0]));
      for (int i = 0; i < 3; ++i)
        result.barycentric[i] = quotient(dot<3>(cross(v[(i + 1) % 3], v[(i + 2) % 3]), n), offset.denominator, 0);
    }
  }
  return result;
}

}  // namespace

template <int D>
PreciseOffset<D> precise_offset(const Vec<D>& p, const TargetSimplex<D>& target) {
  if constexpr (D == 3) {
    PreciseOffset<D> result;
    if (double_double::find_offset(p, target, result)) return result;
  }
  return exact_offset(p, target);
}

template PreciseOffset<2> precise_offset<2>(const Vec2&, const TargetSimplex<2>&);
template PreciseOffset<3> precise_offset<3>(const Vec3&, const TargetSimplex<3>&);

}  // namespace selvage
