#include "geometry/continuous_exact.h"

#include <algorithm>
#include <array>

#include "geometry/exact_integer.h"
#include "geometry/real_root.h"

namespace selvage {

namespace {

using MovingPoint = std::array<Cubic, 3>;

/// The polynomials of time by whose signs it is known whether two sets of four points in all meet.
///
/// All moments at which they meet are a closed set, and between two neighbouring roots of polynomials that tell the
/// answer it is all or nothing: if the sets meet at all, then at time 0, at time 1 or at such a root. Which polynomials
/// tell depends: where the volume is not always zero, it must be zero. Else, if the shadows of the points on one
/// coordinate plane are not always collinear, their areas tell, except at roots of all of them. Else all is on one line
/// always, and the differences along one axis tell, in the same way. Each group of polynomials is one such case, and
/// the first that is not zero throughout decides.
class SignConditions {
 public:
  SignConditions(ContinuousPair pair, const MovingPoints& points, int last_step);

  bool ever_hold() const;
  /// The first of so many equal steps, a power of two of them, in which they hold, ends included.
  std::optional<int> first_step_of(int count) const;

 private:
  static constexpr int kPoints = 4;
  static constexpr int kTriples = 4;  ///< triple i is all points but i, in order
  static constexpr int kPairs = 6;

  using Areas = std::array<Cubic, kTriples>;
  using Distances = std::array<Cubic, kPairs>;

  ContinuousPair pair_;
  std::array<MovingPoint, kPoints> points_;
  Cubic volume_;

  static int pair_index(int i, int j) { return i == 0 ? j - 1 : i + j; }
  Areas areas_along(int axis) const;
  /// Of each pair, the second minus the first.
  Distances distances_along(int axis) const;

  template <class SignAt>
  bool hold(SignAt&& sign_at) const;
  bool shadows_meet(const std::array<int, kTriples>& areas) const;
  template <class SignAt>
  bool intervals_meet(SignAt&& sign_at) const;
  /// Calls `visit(root)` for the roots inside (0, 1) of what decides, until it returns true.
  /// @return whether it did
  template <class Visit>
  bool visit_roots(Visit&& visit) const;
  bool holds_at(RealRoot& root) const {
    return hold([&root](const Cubic& c) { return root.sign_of_value(c); });
  }
};

/// The points' coordinates from 0 to the last step as lines over [0, 1], all times one power of two.
std::array<MovingPoint, 4> integer_motion(const MovingPoints& points, int last_step) {
  std::array<double, 24> values;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) {
      values[3 * i + k] = points.t0[i][k];
      values[12 + 3 * i + k] = points.t1[i][k];
    }
  std::array<ExactInt, 24> x;
  to_common_integers(values, x);
  const bool whole = last_step == kTimeSteps;
  std::array<MovingPoint, 4> motion;
  for (int i = 0; i < 12; ++i)
    motion[i / 3][i % 3] = whole ? Cubic(x[i], x[12 + i])
                                 : Cubic(x[i] * kTimeSteps, x[i] * (kTimeSteps - last_step) + x[12 + i] * last_step);
  return motion;
}

Cubic shadow_area(const MovingPoint& p, const MovingPoint& q, const MovingPoint& r, int axis) {
  const int x = (axis + 1) % 3, y = (axis + 2) % 3;
  return (q[x] - p[x]) * (r[y] - p[y]) - (q[y] - p[y]) * (r[x] - p[x]);
}

SignConditions::SignConditions(ContinuousPair pair, const MovingPoints& points, int last_step)
    : pair_(pair), points_(integer_motion(points, last_step)) {
  for (int axis = 0; axis < 3; ++axis)
    volume_ = volume_ + shadow_area(points_[1], points_[2], points_[3], axis) * (points_[1][axis] - points_[0][axis]);
}

SignConditions::Areas SignConditions::areas_along(int axis) const {
  const auto& [p, q, r, s] = points_;
  return {shadow_area(q, r, s, axis), shadow_area(p, r, s, axis), shadow_area(p, q, s, axis),
          shadow_area(p, q, r, axis)};
}

SignConditions::Distances SignConditions::distances_along(int axis) const {
  Distances distances;
  for (int i = 0; i < kPoints; ++i)
    for (int j = i + 1; j < kPoints; ++j) distances[pair_index(i, j)] = points_[j][axis] - points_[i][axis];
  return distances;
}

/// The shadows of two sets in one plane, on a coordinate plane that shows it properly, given the orientations of all
/// triples, not all 0: they are apart exactly when a line along an edge of either parts them.
bool SignConditions::shadows_meet(const std::array<int, kTriples>& areas) const {
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
template <class SignAt>
bool SignConditions::intervals_meet(SignAt&& sign_at) const {
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
template <class SignAt>
bool SignConditions::hold(SignAt&& sign_at) const {
  if (sign_at(volume_) != 0) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const Areas polynomials = areas_along(axis);
    std::array<int, kTriples> areas;
    std::transform(polynomials.begin(), polynomials.end(), areas.begin(), sign_at);
    if (areas != std::array<int, kTriples>{}) return shadows_meet(areas);
  }
  return intervals_meet(sign_at);
}

template <class Visit>
bool SignConditions::visit_roots(Visit&& visit) const {
  const auto visit_group = [&visit](const auto& group) {
    for (const Cubic& polynomial : group) {
      if (polynomial.is_zero()) continue;
      for (RealRoot& root : roots_inside_unit_interval(polynomial))
        if (visit(root)) return true;
    }
    return false;
  };
  const auto is_zero = [](const auto& group) {
    return std::all_of(group.begin(), group.end(), [](const Cubic& c) { return c.is_zero(); });
  };
  if (!volume_.is_zero()) return visit_group(std::array{volume_});
  for (int axis = 0; axis < 3; ++axis)
    if (const Areas group = areas_along(axis); !is_zero(group)) return visit_group(group);
  for (int axis = 0; axis < 3; ++axis)
    if (const Distances group = distances_along(axis); !is_zero(group)) return visit_group(group);
  return false;
}

bool SignConditions::ever_hold() const {
  if (hold([](const Cubic& c) { return c.sign_at_0(); })) return true;
  if (hold([](const Cubic& c) { return c.sign_at_1(); })) return true;
  return visit_roots([this](RealRoot& root) { return holds_at(root); });
}

std::optional<int> SignConditions::first_step_of(int count) const {
  if (hold([](const Cubic& c) { return c.sign_at_0(); })) return 0;
  int first = count;
  visit_roots([&](RealRoot& root) {
    if (const int step = root.first_step_of(count); step < first && holds_at(root)) first = step;
    return false;
  });
  if (first < count) return first;
  if (hold([](const Cubic& c) { return c.sign_at_1(); })) return count - 1;
  return std::nullopt;
}

}  // namespace

bool meets_exactly(ContinuousPair pair, const MovingPoints& points, int last_step) {
  return SignConditions(pair, points, last_step).ever_hold();
}

std::optional<int> first_step_exactly(ContinuousPair pair, const MovingPoints& points, int last_step) {
  return SignConditions(pair, points, last_step).first_step_of(last_step);
}

}  // namespace selvage
