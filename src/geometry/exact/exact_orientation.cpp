#include "geometry/exact/exact_orientation.h"

#include <cmath>

#include "geometry/exact/exact_integer.h"
#include "geometry/exact/expansion.h"

namespace selvage {

namespace {

/// The coordinates of all points as integers of one common scale.
template <int D, std::size_t N>
std::array<std::array<ExactInt, D>, N> integer_coordinates(const std::array<Vec<D>, N>& points) {
  std::array<double, D * N> values;
  for (std::size_t i = 0; i < N; ++i)
    for (int k = 0; k < D; ++k) values[i * D + k] = points[i][k];
  std::array<ExactInt, D * N> integers;
  to_common_integers(values, integers);
  std::array<std::array<ExactInt, D>, N> coordinates;
  for (std::size_t i = 0; i < N; ++i)
    for (int k = 0; k < D; ++k) coordinates[i][k] = integers[i * D + k];
  return coordinates;
}

}  // namespace

template <int D, int N>
bool expansions_are_exact(const std::array<Vec<D>, N>& points) {
  const double largest = std::ldexp(1.0, kExpansionExponentLimit), smallest = std::ldexp(1.0, -kExpansionExponentLimit);
  for (const Vec<D>& point : points)
    for (int k = 0; k < D; ++k) {
      const double magnitude = std::abs(point[k]);
      if (magnitude != 0 && !(magnitude >= smallest && magnitude <= largest)) return false;
    }
  return true;
}

template bool expansions_are_exact<2, 3>(const std::array<Vec2, 3>&);
template bool expansions_are_exact<3, 4>(const std::array<Vec3, 4>&);

int orient2d_by_expansions(const std::array<Vec2, 3>& points) {
  const auto& [a, b, c] = points;
  const Expansion<2> ux = exact_difference(b[0], a[0]), uy = exact_difference(b[1], a[1]);
  const Expansion<2> vx = exact_difference(c[0], a[0]), vy = exact_difference(c[1], a[1]);
  return (ux * vy + -(uy * vx)).sign();
}

int orient3d_by_expansions(const std::array<Vec3, 4>& points) {
  std::array<std::array<Expansion<2>, 3>, 3> rows;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) rows[i][k] = exact_difference(points[i + 1][k], points[0][k]);
  const auto& [u, v, w] = rows;
  const Expansion<16> x = v[1] * w[2] + -(v[2] * w[1]);
  const Expansion<16> y = v[2] * w[0] + -(v[0] * w[2]);
  const Expansion<16> z = v[0] * w[1] + -(v[1] * w[0]);
  return (x * u[0] + y * u[1] + z * u[2]).sign();
}

int orient2d_by_integers(const std::array<Vec2, 3>& points) {
  const auto [a, b, c] = integer_coordinates(points);
  return sign_of((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

int orient3d_by_integers(const std::array<Vec3, 4>& points) {
  const auto coordinates = integer_coordinates(points);
  std::array<std::array<ExactInt, 3>, 3> rows;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) rows[i][k] = coordinates[i + 1][k] - coordinates[0][k];
  const auto& [u, v, w] = rows;
  return sign_of(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
                 u[2] * (v[0] * w[1] - v[1] * w[0]));
}

}  // namespace selvage
