#include "boundary_path/injectivity/ridge_turns.h"

#include "selvage/geometry/predicates.h"

#include <cmath>

namespace selvage {

namespace {

/// In which half turn from the direction of `first` a link vertex lies: 0 the first half, `first`'s own direction
/// included, 1 the second. Exact.
int half_turn(std::span<const Vec3> x, const VertexTuple<2>& ridge, Index first, Index v) {
  const Vec3 axis = x[ridge[1]] - x[ridge[0]], a = x[first] - x[ridge[0]], b = x[v] - x[ridge[0]];
  const Vec3 across = axis.cross(a);
  const double height = across.dot(b);
  const double bound =
      64 * 0x1p-53 * axis.lpNorm<Eigen::Infinity>() * a.lpNorm<Eigen::Infinity>() * b.lpNorm<Eigen::Infinity>();
  const int sign =
      std::abs(height) > bound + 0x1p-900 ? (height > 0 ? 1 : -1) : orient3d(x[ridge[0]], x[ridge[1]], x[first], x[v]);
  if (sign != 0) return sign > 0 ? 0 : 1;
  return across.dot(axis.cross(b)) >= 0 ? 0 : 1;
}

int half_turn(std::span<const Vec2> x, const VertexTuple<1>& ridge, Index first, Index v) {
  const int sign = orient2d(x[ridge[0]], x[first], x[v]);
  if (sign != 0) return sign > 0 ? 0 : 1;
  return (x[first] - x[ridge[0]]).dot(x[v] - x[ridge[0]]) >= 0 ? 0 : 1;
}

/// How often the link comes around to the direction of its first vertex.
template <int D>
int count_turns(std::span<const Vec<D>> x, const VertexTuple<D - 1>& ridge, std::span<const Index> link) {
  int turns = 0;
  for (std::size_t i = 1, before = 0; i < link.size(); ++i) {
    const std::size_t half = half_turn(x, ridge, link[0], link[i]);
    turns += before == 1 && half == 0;
    before = half;
  }
  return turns;
}

/// Whether the link ends exactly in the direction in which it began.
template <int D>
bool ends_where_it_began(std::span<const Vec<D>> x, const VertexTuple<D - 1>& ridge, std::span<const Index> link) {
  std::array<Vec<D>, D + 1> corners;
  for (int i = 0; i < D - 1; ++i) corners[i] = x[ridge[i]];
  corners[D - 1] = x[link.front()];
  corners[D] = x[link.back()];
  return orientation(corners) == 0 && half_turn(x, ridge, link.front(), link.back()) == 0;
}

}  // namespace

bool turns_once(std::span<const Vec2> positions, const VertexTuple<1>& ridge, std::span<const Index> link) {
  return count_turns<2>(positions, ridge, link) == 0;
}

/// First some vertices on the one side, then the rest on the other. What plain arithmetic leaves open is decided
/// exactly.
bool turns_once(std::span<const Vec3> positions, const VertexTuple<2>& ridge, std::span<const Index> link) {
  const Vec3& foot = positions[ridge[0]];
  const Vec3 axis = positions[ridge[1]] - foot, first = positions[link[0]] - foot;
  const Vec3 across = axis.cross(first);
  const double length = across.lpNorm<1>();
  bool sure = length > 1e-3 * axis.lpNorm<1>() * first.lpNorm<1>(), back = false;
  for (std::size_t i = 2; sure && i < link.size(); ++i) {
    const Vec3 arm = positions[link[i]] - foot;
    const double height = across.dot(arm);
    sure = std::abs(height) > 1e-12 * length * arm.lpNorm<1>() + 0x1p-900 && !(back && height > 0);
    back = height < 0;
  }
  return sure || count_turns<3>(positions, ridge, link) == 0;
}

bool turns_beyond(std::span<const Vec2> positions, const VertexTuple<1>& ridge, std::span<const Index> link) {
  const int turns = count_turns<2>(positions, ridge, link);
  return turns > 1 || (turns == 1 && !ends_where_it_began<2>(positions, ridge, link));
}

bool turns_beyond(std::span<const Vec3> positions, const VertexTuple<2>& ridge, std::span<const Index> link) {
  const int turns = count_turns<3>(positions, ridge, link);
  return turns > 1 || (turns == 1 && !ends_where_it_began<3>(positions, ridge, link));
}

}  // namespace selvage
