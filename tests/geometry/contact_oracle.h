#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstddef>
#include <cstdint>

#include "geometry/exact_oracle.h"
#include "selvage/geometry/triangle_triangle.h"

namespace selvage::test {

/// Exact vectors of any kind of number: machine integers on a lattice, big integers for doubles.
template <class T>
using ExactVec = std::array<T, 3>;
template <class T>
using ExactTriangle = std::array<ExactVec<T>, 3>;

template <class T>
ExactVec<T> operator-(const ExactVec<T>& a, const ExactVec<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T dot(const ExactVec<T>& a, const ExactVec<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
ExactVec<T> cross(const ExactVec<T>& a, const ExactVec<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class T>
bool is_zero(const ExactVec<T>& a) {
  return sign(a[0]) == 0 && sign(a[1]) == 0 && sign(a[2]) == 0;
}

/// Where 0 lies with regard to the hull of some points. Two convex sets meet where it is in the hull of all differences
/// of their vertices, their relative interiors where it is in the relative interior of that hull.
template <class T, int Count>
class HullOfPoints {
 public:
  explicit HullOfPoints(const std::array<ExactVec<T>, Count>& points) : d_(points) {
    for (int i = 0; i < kCount; ++i)
      for (int j = 0; j < kCount; ++j) cross_[i][j] = cross(d_[i], d_[j]);
  }

  /// Caratheodory: 0 is in the hull of at most four of the points, affinely independent.
  bool has_zero() const {
    for (int i = 0; i < kCount; ++i)
      for (int j = i; j < kCount; ++j)
        if (is_zero(cross_[i][j]) && sign(dot(d_[i], d_[j])) <= 0) return true;
    for (int i = 0; i < kCount; ++i)
      for (int j = i + 1; j < kCount; ++j)
        for (int k = j + 1; k < kCount; ++k) {
          if (sign(det(i, j, k)) == 0 && triangle_has_zero(i, j, k)) return true;
          for (int l = k + 1; l < kCount; ++l)
            if (tetrahedron_has_zero(i, j, k, l)) return true;
        }
    return false;
  }

  /// 0 is in the relative interior unless a half-space through 0 holds all points, some of them inside. Where there is
  /// one, one has a border through as many independent points as the points' span allows.
  bool has_zero_inside() const {
    const ExactVec<T>* normal = nullptr;
    for (int i = 0; i < kCount; ++i)
      for (int j = i + 1; j < kCount; ++j) {
        if (is_zero(cross_[i][j])) continue;
        normal = &cross_[i][j];
        if (all_on_one_side(cross_[i][j])) return false;
      }
    const bool flat = normal == nullptr || lies_on(*normal);
    for (int i = 0; i < kCount && flat; ++i)
      if (all_on_one_side(normal == nullptr ? d_[i] : cross(*normal, d_[i]))) return false;
    return true;
  }

 private:
  static constexpr int kCount = Count;
  std::array<ExactVec<T>, kCount> d_;
  std::array<std::array<ExactVec<T>, kCount>, kCount> cross_;

  T det(int i, int j, int k) const { return dot(cross_[i][j], d_[k]); }

  bool triangle_has_zero(int i, int j, int k) const {
    const auto &x = cross_[i][j], &y = cross_[j][k], &z = cross_[k][i];
    if (is_zero(x) && is_zero(y) && is_zero(z)) return false;
    return sign(dot(x, y)) >= 0 && sign(dot(y, z)) >= 0 && sign(dot(z, x)) >= 0;
  }
  bool tetrahedron_has_zero(int i, int j, int k, int l) const {
    const int signs[] = {sign(det(j, k, l)), -sign(det(i, k, l)), sign(det(i, j, l)), -sign(det(i, j, k))};
    bool above = false, below = false;
    for (int s : signs) {
      above |= s > 0;
      below |= s < 0;
    }
    return above != below;
  }
  bool lies_on(const ExactVec<T>& normal) const {
    for (const auto& d : d_)
      if (dot(normal, d) != 0) return false;
    return true;
  }
  bool all_on_one_side(const ExactVec<T>& normal) const {
    bool above = false, below = false;
    for (const auto& d : d_) {
      const T height = dot(normal, d);
      above |= height > 0;
      below |= height < 0;
    }
    return above != below;
  }
};

template <class T>
bool in_one_plane(const ExactTriangle<T>& a, const ExactTriangle<T>& b) {
  const std::array<ExactVec<T>, 5> edges{a[1] - a[0], a[2] - a[0], b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  for (int i = 0; i < 5; ++i)
    for (int j = i + 1; j < 5; ++j)
      for (int k = j + 1; k < 5; ++k)
        if (dot(cross(edges[i], edges[j]), edges[k]) != 0) return false;
  return true;
}

template <class T>
TriangleContact contact_by_definition(const ExactTriangle<T>& a, const ExactTriangle<T>& b) {
  std::array<ExactVec<T>, 9> differences;
  for (int i = 0; i < 9; ++i) differences[i] = a[i / 3] - b[i % 3];
  const HullOfPoints<T, 9> hull(differences);
  if (!hull.has_zero()) return TriangleContact::kDisjoint;
  if (!hull.has_zero_inside()) return TriangleContact::kTouching;
  return in_one_plane(a, b) ? TriangleContact::kCoplanarOverlap : TriangleContact::kCrossing;
}

/// Whether x, not 0, is a sum of multiples, not negative, of u and v.
template <class T>
bool cone_holds(const ExactVec<T>& u, const ExactVec<T>& v, const ExactVec<T>& x) {
  const ExactVec<T> normal = cross(u, v);
  if (is_zero(normal)) return (is_zero(cross(u, x)) && dot(u, x) > 0) || (is_zero(cross(v, x)) && dot(v, x) > 0);
  return dot(normal, x) == 0 && dot(normal, cross(u, x)) >= 0 && dot(normal, cross(x, v)) >= 0;
}

/// Near the common vertex both triangles are cones. Cones with another point than 0 in common have one on an edge of
/// one of them, or where their planes cross.
template <class T>
bool meet_beyond_vertex_by_definition(const ExactTriangle<T>& a, const ExactTriangle<T>& b) {
  const ExactVec<T> u = a[1] - a[0], v = a[2] - a[0], x = b[1] - b[0], y = b[2] - b[0];
  const ExactVec<T> line = cross(cross(u, v), cross(x, y)), back = ExactVec<T>{} - line;
  for (const ExactVec<T>& candidate : {u, v, x, y, line, back})
    if (!is_zero(candidate) && cone_holds(u, v, candidate) && cone_holds(x, y, candidate)) return true;
  return false;
}

template <class T>
bool meet_beyond_edge_by_definition(const ExactTriangle<T>& a, const ExactTriangle<T>& b) {
  const ExactVec<T> edge = a[1] - a[0], to_a = a[2] - a[0], to_b = b[2] - a[0];
  if (is_zero(edge)) return is_zero(cross(to_a, to_b)) && dot(to_a, to_b) > 0;
  const ExactVec<T> normal_a = cross(edge, to_a), normal_b = cross(edge, to_b);
  if (!is_zero(normal_a) || !is_zero(normal_b))
    return is_zero(cross(normal_a, normal_b)) && dot(normal_a, normal_b) > 0;
  const T place_a = dot(edge, to_a), place_b = dot(edge, to_b), length = dot(edge, edge);
  return (place_a < 0 && place_b < 0) || (place_a > length && place_b > length);
}

/// Integers for products of seven differences of coordinates of 64 bits, and for any.
using Wide = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 512, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked, void>,
    boost::multiprecision::et_off>;
using Unlimited = boost::multiprecision::cpp_int;

/// The double times 2^1074, an integer.
inline Unlimited fixed_point(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto biased_exponent = static_cast<unsigned>(bits >> 52 & 0x7ff);
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
  Unlimited result = biased_exponent == 0 ? fraction : fraction | std::uint64_t{1} << 52;
  if (biased_exponent > 1) result <<= biased_exponent - 1;
  return value < 0 ? Unlimited(-result) : result;
}

/// The points with all coordinates times 2^1074 and divided by the largest power of two that leaves them integers.
template <class T, std::size_t N>
std::array<ExactVec<T>, N> to_exact(const std::array<Vec3, N>& points) {
  std::array<ExactVec<Unlimited>, N> fixed;
  unsigned shift = 4096;
  for (std::size_t i = 0; i < N; ++i)
    for (int k = 0; k < 3; ++k) {
      fixed[i][k] = fixed_point(points[i][k]);
      if (fixed[i][k] != 0) shift = std::min(shift, static_cast<unsigned>(lsb(abs(fixed[i][k]))));
    }
  std::array<ExactVec<T>, N> result;
  for (std::size_t i = 0; i < N; ++i)
    for (int k = 0; k < 3; ++k) {
      const bool negative = fixed[i][k] < 0;
      const Unlimited magnitude = abs(fixed[i][k]) >> shift;
      result[i][k] = negative ? -static_cast<T>(magnitude) : static_cast<T>(magnitude);
    }
  return result;
}

}  // namespace selvage::test
