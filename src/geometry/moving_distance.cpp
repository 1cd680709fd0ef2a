#include "selvage/geometry/moving_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "selvage/geometry/closest_point.h"
#include "selvage/geometry/distance.h"

namespace selvage {

namespace {

/// Halves the time until each part is decided: by a moment at which the sets are near; or by the direction in which
/// they lie apart in its middle, if they lie apart along it at both ends too, and so throughout, by linearity. Sets
/// that slide along each other without coming near are decided at once, whatever their speed.
template <int kFirst>
class NearnessSearch {
 public:
  NearnessSearch(const MovingPoints& points, double distance) {
    // By a power of two, so that squares neither overflow nor vanish; as point 0 sees the others.
    double largest = distance;
    for (const auto* positions : {&points.t0, &points.t1})
      for (const Vec3& x : *positions) largest = std::max(largest, x.cwiseAbs().maxCoeff());
    const double scale = std::ldexp(1.0, -std::clamp(std::ilogb(largest) + 2, -1000, 1000));
    distance_ = distance * scale;
    for (int i = 0; i < 4; ++i) {
      start_[i] = points.t0[i] * scale - points.t0[0] * scale;
      end_[i] = points.t1[i] * scale - points.t1[0] * scale;
    }
    for (int i = 0; i < kFirst; ++i)
      for (int j = kFirst; j < 4; ++j) {
        const Vec3 relative = (end_[j] - start_[j]) - (end_[i] - start_[i]);
        fastest_ = std::max(fastest_, relative.norm());
      }
  }

  bool come_near(double from, double to) const {
    const double middle = (from + to) / 2;
    const Vec3 across = difference_at(middle);
    const double apart = across.norm();
    if (apart < distance_) return true;
    if (gap_along(across, from) >= distance_ * apart && gap_along(across, to) >= distance_ * apart) return false;
    // Points get closer by no more than their relative speed lets them.
    const double reach = (to - from) / 2 * fastest_;
    if (apart - reach > distance_) return false;
    if (reach <= kTolerance * distance_ || to - from < kShortest) return true;
    return come_near(from, middle) || come_near(middle, to);
  }

  /// The beginning of the first part of the time in which the sets are not certainly apart, if it is below `before`.
  std::optional<double> find_first(double from, double to, double before) const {
    if (from >= before) return std::nullopt;
    const double middle = (from + to) / 2;
    const Vec3 across = difference_at(middle);
    const double apart = across.norm();
    if (apart >= distance_) {
      if (gap_along(across, from) >= distance_ * apart && gap_along(across, to) >= distance_ * apart)
        return std::nullopt;
      const double reach = (to - from) / 2 * fastest_;
      if (apart - reach > distance_) return std::nullopt;
      if (reach <= kTolerance * distance_) return from;
    }
    if (to - from <= kTimeStep) return from;
    const auto first = find_first(from, middle, before);
    return first ? first : find_first(middle, to, before);
  }

  bool are_near(double time) const { return difference_at(time).norm() < distance_; }

 private:
  static constexpr double kTolerance = 0x1p-20, kShortest = 0x1p-40, kTimeStep = 0x1p-20;

  Vec3 at(int i, double time) const { return (1 - time) * start_[i] + time * end_[i]; }

  /// From the first set to the second, where they are closest.
  Vec3 difference_at(double time) const {
    if constexpr (kFirst == 1)
      return closest_point_on_triangle(at(0, time), at(1, time), at(2, time), at(3, time)).point - at(0, time);
    else
      return closest_difference({at(0, time), at(1, time)}, {at(2, time), at(3, time)});
  }

  /// How far the second set lies behind the first.
  double gap_along(const Vec3& direction, double time) const {
    double first = -std::numeric_limits<double>::infinity(), second = -first;
    for (int i = 0; i < 4; ++i) {
      const double height = direction.dot(at(i, time));
      if (i < kFirst)
        first = std::max(first, height);
      else
        second = std::min(second, height);
    }
    return second - first;
  }

  std::array<Vec3, 4> start_, end_;
  double distance_ = 0, fastest_ = 0;
};

template <int kFirst>
std::optional<double> first_nearness(const MovingPoints& points, double distance, double before) {
  const NearnessSearch<kFirst> search(points, distance);
  return search.are_near(0) ? (before > 0 ? std::optional(0.0) : std::nullopt) : search.find_first(0, 1, before);
}

}  // namespace

bool vertex_comes_near_face(const MovingPoints& points, double distance) {
  return distance > 0 && NearnessSearch<1>(points, distance).come_near(0, 1);
}

bool edge_comes_near_edge(const MovingPoints& points, double distance) {
  return distance > 0 && NearnessSearch<2>(points, distance).come_near(0, 1);
}

std::optional<double> vertex_face_nearness(const MovingPoints& points, double distance, double before) {
  return first_nearness<1>(points, distance, before);
}

std::optional<double> edge_edge_nearness(const MovingPoints& points, double distance, double before) {
  return first_nearness<2>(points, distance, before);
}

}  // namespace selvage
