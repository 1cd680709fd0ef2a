#include "geometry/exact/continuous_exact.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "geometry/exact/exact_integer.h"
#include "geometry/exact/fixed_integer.h"
#include "geometry/exact/fixed_root.h"
#include "geometry/exact/real_root.h"

namespace selvage {

namespace {

/// The coordinates of four points at time 0 and at time 1 along each axis: those along one axis as integers times one
/// power of two, which changes no sign of what follows.
using Coordinates = std::array<CommonDyadic<8>, 3>;

Coordinates to_integers(const MovingPoints& points) {
  Coordinates coordinates;
  for (int k = 0; k < 3; ++k) {
    std::array<double, 8> values;
    for (int i = 0; i < 4; ++i) {
      values[i] = points.t0[i][k];
      values[4 + i] = points.t1[i][k];
    }
    coordinates[k] = to_common_dyadic(values);
  }
  return coordinates;
}

/// The polynomials of time whose signs decide whether two sets of four points in all meet.
///
/// All moments at which they meet are a closed set, and between two neighbouring roots of the polynomials that decide
/// it is all or nothing: if the sets meet at all, then at time 0, at the end or at such a root. Which
/// polynomials decide depends: where the volume is not always zero, it must be zero. Else, if the projections of the
/// points on one coordinate plane are not always collinear, their areas decide, except at roots of all of them. Else
/// all is on one line always, and the differences along one axis decide, in the same way. Each group of polynomials is
/// one such case, and the first that is not zero throughout decides.
///
/// With integers that grow there is always an answer. With fixed ones there is none where two roots, or a root and the
/// root of a polynomial whose sign is asked for there, are too close to each other.
template <class Int>
class SignConditions {
 public:
  /// @param first_axis  the one along which projections are looked at first
  SignConditions(ContinuousPair pair, const Coordinates& coordinates, int first_axis);

  /// The first of `kTimeSteps` in which they hold, ends included; `last_step` if not before its end.
  std::optional<int> first_step(int last_step) const;

 private:
  static constexpr int kPoints = 4;
  static constexpr int kTriples = 4;  ///< triple i is all points but i, in order
  static constexpr int kPairs = 6;

  using Line = Polynomial<Int, 1>;
  using Area = decltype(Line() * Line());
  using Volume = decltype(Area() * Line());
  using Areas = std::array<Area, kTriples>;
  using Distances = std::array<Line, kPairs>;

  ContinuousPair pair_;
  int first_axis_;
  std::array<std::array<Line, 3>, kPoints> points_;
  Volume volume_;

  static int pair_index(int i, int j) { return i == 0 ? j - 1 : i + j; }
  Area projected_area(int p, int q, int r, int axis) const;
  Areas areas_along(int axis) const;
  /// Of each pair, the second minus the first.
  Distances distances_along(int axis) const;

  template <class SignAt>
  bool hold(SignAt&& sign_at) const;
  bool projections_meet(const std::array<int, kTriples>& areas) const;
  template <class SignAt>
  bool intervals_meet(SignAt&& sign_at) const;
  /// Calls `visit(root)` for the roots inside (0, 1) of what decides.
  /// @return whether these are all
  template <class Visit>
  bool visit_deciding_roots(Visit&& visit) const;
};

template <class Int>
SignConditions<Int>::SignConditions(ContinuousPair pair, const Coordinates& coordinates, int first_axis)
    : pair_(pair), first_axis_(first_axis) {
  for (int i = 0; i < kPoints; ++i)
    for (int k = 0; k < 3; ++k)
      points_[i][k] = line(coordinates[k].integer<Int>(i), coordinates[k].integer<Int>(4 + i));
  for (int k = 0; k < 3; ++k) volume_ += projected_area(1, 2, 3, k) * (points_[1][k] - points_[0][k]);
}

template <class Int>
auto SignConditions<Int>::projected_area(int p, int q, int r, int axis) const -> Area {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  const auto side = [this, p](int to, int k) { return points_[to][k] - points_[p][k]; };
  return side(q, x) * side(r, y) - side(q, y) * side(r, x);
}

template <class Int>
auto SignConditions<Int>::areas_along(int axis) const -> Areas {
  return {projected_area(1, 2, 3, axis), projected_area(0, 2, 3, axis), projected_area(0, 1, 3, axis),
          projected_area(0, 1, 2, axis)};
}

template <class Int>
auto SignConditions<Int>::distances_along(int axis) const -> Distances {
  Distances distances;
  for (int i = 0; i < kPoints; ++i)
    for (int j = i + 1; j < kPoints; ++j) distances[pair_index(i, j)] = points_[j][axis] - points_[i][axis];
  return distances;
}

/// The projections of two sets in one plane, on a coordinate plane that shows it properly, given the orientations of
/// all triples, not all 0: they are apart exactly when a line along an edge of either parts them.
template <class Int>
bool SignConditions<Int>::projections_meet(const std::array<int, kTriples>& areas) const {
  if (pair_ == ContinuousPair::kEdgeEdge) {
    const int third_over_first = areas[3], fourth_over_first = areas[2];
    const int first_over_second = areas[1], second_over_second = areas[0];
    return third_over_first * fourth_over_first <= 0 && first_over_second * second_over_second <= 0;
  }
  // The vertex with each of the face's edges 12, 23 and 31.
  const int face = areas[0];
  const auto beyond = [face](int area) { return area != 0 && area != face; };
  return !beyond(areas[3]) && !beyond(areas[1]) && !beyond(-areas[2]);
}

/// On one line, the sets meet when they do along each axis.
template <class Int>
template <class SignAt>
bool SignConditions<Int>::intervals_meet(SignAt&& sign_at) const {
  const int first_count = pair_ == ContinuousPair::kVertexFace ? 1 : 2;
  for (int axis = 0; axis < 3; ++axis) {
    const Distances distances = distances_along(axis);
    bool some_before = false, some_behind = false;
    for (int i = 0; i < first_count; ++i)
      for (int j = first_count; j < kPoints; ++j) {
        const int sign = sign_at(distances[pair_index(i, j)]);
        some_before |= sign >= 0;
        some_behind |= sign <= 0;
      }
    if (!some_before || !some_behind) return false;
  }
  return true;
}

/// Whether the sets meet at the time at which `sign_at` tells signs.
template <class Int>
template <class SignAt>
bool SignConditions<Int>::hold(SignAt&& sign_at) const {
  if (sign_at(volume_) != 0) return false;
  for (int i = 0; i < 3; ++i) {
    const Areas polynomials = areas_along((first_axis_ + i) % 3);
    std::array<int, kTriples> areas;
    std::transform(polynomials.begin(), polynomials.end(), areas.begin(), sign_at);
    if (areas != std::array<int, kTriples>{}) return projections_meet(areas);
  }
  return intervals_meet(sign_at);
}

template <class Int>
template <class Visit>
bool SignConditions<Int>::visit_deciding_roots(Visit&& visit) const {
  if (!volume_.is_zero()) return visit_roots(volume_, visit);
  const auto is_zero = [](const auto& group) {
    return std::all_of(group.begin(), group.end(), [](const auto& polynomial) { return polynomial.is_zero(); });
  };
  const auto visit_group = [&visit](const auto& group) {
    return std::all_of(group.begin(), group.end(), [&visit](const auto& polynomial) {
      return polynomial.is_zero() || visit_roots(polynomial, visit);
    });
  };
  for (int i = 0; i < 3; ++i)
    if (const Areas group = areas_along((first_axis_ + i) % 3); !is_zero(group)) return visit_group(group);
  for (int axis = 0; axis < 3; ++axis)
    if (const Distances group = distances_along(axis); !is_zero(group)) return visit_group(group);
  return true;
}

template <class Int>
std::optional<int> SignConditions<Int>::first_step(int last_step) const {
  constexpr int kLog = std::countr_zero(static_cast<unsigned>(kTimeSteps));
  if (hold([](const auto& polynomial) { return polynomial[0].sign(); })) return 0;
  int first = last_step;
  bool is_known = true;
  const bool are_all = visit_deciding_roots([&](auto&& root) {
    const auto known = [&is_known](std::optional<int> answer) {
      is_known &= answer.has_value();
      return answer.value_or(0);
    };
    const int step = known(root.step(kLog));
    if (step < first && hold([&](const auto& polynomial) { return known(root.sign_of_value(polynomial)); }))
      first = step;
  });
  if (!are_all || !is_known) return std::nullopt;
  if (first < last_step) return first;
  const int halvings = std::max(0, kLog - std::countr_zero(static_cast<unsigned>(last_step)));
  const auto sign_at_end = [n = Int(last_step >> (kLog - halvings)), halvings](const auto& polynomial) {
    return on_interval(polynomial, n, halvings)[0].sign();
  };
  return hold(sign_at_end) ? last_step - 1 : last_step;
}

/// The axis along which projections are largest; any where that overflows.
int axis_of_projection(ContinuousPair pair, const MovingPoints& points) {
  const auto& [a, b, c, d] = points.t0;
  const Vec3 normal = (pair == ContinuousPair::kVertexFace ? c - b : b - a).cross(d - c).cwiseAbs();
  const int larger = normal[1] > normal[0] ? 1 : 0;
  return normal[2] > normal[larger] ? 2 : larger;
}

template <class Int>
std::optional<int> first_step_by(ContinuousPair pair, const MovingPoints& points, const Coordinates& coordinates,
                                 int last_step) {
  return SignConditions<Int>(pair, coordinates, axis_of_projection(pair, points)).first_step(last_step);
}

}  // namespace

std::optional<int> first_step_by_fixed_integers(ContinuousPair pair, const MovingPoints& points, int last_step) {
  // With coordinates of b bits coefficients have at most b + 2 in differences of lines, 2 b + 5 in areas and 3 b + 10
  // in the volume: with 4 bits less than whole words they fit into one, two and three times as many, each with its
  // sign.
  const Coordinates coordinates = to_integers(points);
  const int bits = std::max({coordinates[0].bits, coordinates[1].bits, coordinates[2].bits});
  if (bits <= 60) return first_step_by<FixedInt<1>>(pair, points, coordinates, last_step);
  if (bits <= 124) return first_step_by<FixedInt<2>>(pair, points, coordinates, last_step);
  return std::nullopt;
}

int first_step_by_any_integers(ContinuousPair pair, const MovingPoints& points, int last_step) {
  return *first_step_by<ExactInt>(pair, points, to_integers(points), last_step);
}

int first_step_exactly(ContinuousPair pair, const MovingPoints& points, int last_step) {
  const std::optional<int> step = first_step_by_fixed_integers(pair, points, last_step);
  return step ? *step : first_step_by_any_integers(pair, points, last_step);
}

bool meets_exactly(ContinuousPair pair, const MovingPoints& points) {
  return first_step_exactly(pair, points, kTimeSteps) < kTimeSteps;
}

}  // namespace selvage
