#pragma once

#include "selvage/core/types.h"

// GCC 12 takes the small buffer of a big integer for all of its room.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wstringop-overflow"
#pragma GCC diagnostic ignored "-Warray-bounds"
#endif

#include <boost/multiprecision/cpp_int.hpp>

#include <optional>
#include <utility>

namespace selvage::oracle {

using Integer = boost::multiprecision::cpp_int;
using Rational = boost::multiprecision::cpp_rational;

template <int D>
using RationalVec = std::array<Rational, D>;

template <int D>
RationalVec<D> to_rational(const Vec<D>& v) {
  RationalVec<D> result;
  for (int i = 0; i < D; ++i) result[i] = Rational(v[i]);
  return result;
}

template <typename T, std::size_t D>
std::array<T, D> operator-(const std::array<T, D>& a, const std::array<T, D>& b) {
  std::array<T, D> result;
  for (std::size_t i = 0; i < D; ++i) result[i] = a[i] - b[i];
  return result;
}

template <typename T, std::size_t D>
T dot(const std::array<T, D>& a, const std::array<T, D>& b) {
  T sum = a[0] * b[0];
  for (std::size_t i = 1; i < D; ++i) sum += a[i] * b[i];
  return sum;
}

template <typename T>
std::array<T, 3> cross(const std::array<T, 3>& a, const std::array<T, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <typename T>
T determinant(const std::array<T, 2>& a, const std::array<T, 2>& b) {
  return a[0] * b[1] - a[1] * b[0];
}

template <typename T>
T determinant(const std::array<T, 3>& a, const std::array<T, 3>& b, const std::array<T, 3>& c) {
  return dot(a, cross(b, c));
}

/// Point of a face closest to the origin, in rational arithmetic: the best of the feet of the perpendiculars on the
/// affine hulls of all subsets of its vertices, as far as the foot lies inside the subset.
template <int D>
RationalVec<D> closest_to_origin(const std::array<RationalVec<D>, D>& face);

/// The parameters u at which the line u * direction (direction not zero) meets the closed face; nothing where it passes
/// by. Also for faces that contain a piece of the line, and for degenerate faces.
template <int D>
std::optional<std::pair<Rational, Rational>> meet_line(const std::array<RationalVec<D>, D>& face,
                                                       const RationalVec<D>& direction);

extern template RationalVec<2> closest_to_origin<2>(const std::array<RationalVec<2>, 2>&);
extern template RationalVec<3> closest_to_origin<3>(const std::array<RationalVec<3>, 3>&);
extern template std::optional<std::pair<Rational, Rational>> meet_line<2>(const std::array<RationalVec<2>, 2>&,
                                                                          const RationalVec<2>&);
extern template std::optional<std::pair<Rational, Rational>> meet_line<3>(const std::array<RationalVec<3>, 3>&,
                                                                          const RationalVec<3>&);

}  // namespace selvage::oracle
