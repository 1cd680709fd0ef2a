#include "selvage/geometry/continuous.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/continuous_exact.h"

namespace selvage {

namespace {

using detail::VolumeOverTime;

enum class Certainty : std::uint8_t { kNo, kYes, kUnknown };

/// A part of the time, and the volume over it in Bernstein form.
struct TimePart {
  int first_step, last_step;
  std::array<double, 4> volume;
};

/// Halves of time by de Casteljau's algorithm.
std::array<TimePart, 2> halves(const TimePart& part) {
  const auto& [a, b, c, d] = part.volume;
  const double ab = 0.5 * (a + b), bc = 0.5 * (b + c), cd = 0.5 * (c + d);
  const double abc = 0.5 * (ab + bc), bcd = 0.5 * (bc + cd), middle = 0.5 * (abc + bcd);
  const int middle_step = part.first_step + (part.last_step - part.first_step) / 2;
  return {TimePart{part.first_step, middle_step, {a, ab, abc, middle}},
          TimePart{middle_step, part.last_step, {middle, bcd, cd, d}}};
}

/// A number known to lie within `radius` of `value`.
struct Interval {
  double value, radius;
};

Interval difference(const Interval& a, const Interval& b) {
  const double value = a.value - b.value;
  return {value, (a.radius + b.radius) + 0x1p-52 * std::abs(value)};
}

/// Sign of a x d - b x c for the given intervals; 0: not known.
int sign_of_det(const Interval& a, const Interval& b, const Interval& c, const Interval& d) {
  const double left = a.value * d.value, right = b.value * c.value;
  const double spread = std::abs(a.value) * d.radius + a.radius * (std::abs(d.value) + d.radius) +
                        std::abs(b.value) * c.radius + b.radius * (std::abs(c.value) + c.radius);
  constexpr double kRoundingOfBound = 1 + 0x1p-40;
  const double rounding = detail::kRelativeError2d * (std::abs(left) + std::abs(right)) + detail::kUnderflowError;
  return detail::certain_sign(left - right, kRoundingOfBound * spread + rounding);
}

/// Decides by halving the time, in floating point with bounds of all errors. In a part of time the sets do not meet if
/// the volume is not zero there, or if the shadows of the sets on some coordinate plane do not meet; they do if the
/// volume changes its sign while the shadows cross properly, for then some moment brings all into one plane.
class TimeHalving {
 public:
  TimeHalving(ContinuousPair pair, const MovingPoints& points, const VolumeOverTime& volume)
      : pair_(pair), points_(points) {
    double largest = 0;
    for (double c : volume.coefficient) largest = std::max(largest, std::abs(c));
    constexpr double kErrorOfHalvings = 0x1p-47;  // 3 roundings of 2^-53 for each of 20 halvings
    constexpr double kLargestSum = 0x1p1000;      // sums of two do not overflow
    volume_error_ = largest < kLargestSum ? volume.error + kErrorOfHalvings * largest : HUGE_VAL;
    for (int i = 1; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        start_[i][k] = points.t0[i][k] - points.t0[0][k];
        end_[i][k] = points.t1[i][k] - points.t1[0][k];
      }
  }

  Certainty decide(const TimePart& part) {
    parts_left_ = kMostParts;
    return decide_part(part);
  }

  bool meets(const TimePart& part) {
    const Certainty certainty = decide(part);
    if (certainty != Certainty::kUnknown) return certainty == Certainty::kYes;
    return meets_exactly(pair_, points_, part.first_step, part.last_step);
  }

 private:
  static constexpr int kMostParts = 64;

  ContinuousPair pair_;
  const MovingPoints& points_;
  double volume_error_;
  double start_[4][3] = {}, end_[4][3] = {};  ///< relative to point 0
  int parts_left_ = 0;

  using Places = std::array<std::array<Interval, 3>, 4>;

  /// Where the points are during a part of time, relative to point 0.
  Places places_during(const TimePart& part) const {
    constexpr double kStep = 1.0 / kTimeSteps;
    const double middle = 0.5 * kStep * (part.first_step + part.last_step);
    const double reach = 0.5 * kStep * (part.last_step - part.first_step);
    Places places{};
    for (int i = 1; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        const double a = start_[i][k], b = end_[i][k];
        const double rounding = 0x1p-50 * (std::abs(a) + std::abs(b)) + detail::kUnderflowError;
        places[i][k] = {(1 - middle) * a + middle * b, reach * std::abs(b - a) + rounding};
      }
    return places;
  }

  /// Whether the shadows on the coordinate plane in which they are largest certainly meet properly or are apart.
  Certainty shadows_meet(const TimePart& part) const {
    const Places p = places_during(part);
    const int first = pair_ == ContinuousPair::kVertexFace ? 1 : 0;
    int axis = 0;
    double largest = -1;
    for (int k = 0; k < 3; ++k) {
      const int x = (k + 1) % 3, y = (k + 2) % 3;
      const double normal = std::abs((p[first + 1][x].value - p[first][x].value) * (p[3][y].value - p[2][y].value) -
                                     (p[first + 1][y].value - p[first][y].value) * (p[3][x].value - p[2][x].value));
      if (!(normal > largest)) continue;
      largest = normal;
      axis = k;
    }
    const int x = (axis + 1) % 3, y = (axis + 2) % 3;
    const auto area = [&](int i, int j, int k) {
      return sign_of_det(difference(p[j][x], p[i][x]), difference(p[j][y], p[i][y]), difference(p[k][x], p[i][x]),
                         difference(p[k][y], p[i][y]));
    };
    if (pair_ == ContinuousPair::kVertexFace) {
      const auto [low, high] = std::minmax({area(0, 1, 2), area(0, 2, 3), area(0, 3, 1)});
      if (low < 0 && high > 0) return Certainty::kNo;
      return low == high && low != 0 ? Certainty::kYes : Certainty::kUnknown;
    }
    const int of_second = area(0, 1, 2) * area(0, 1, 3), of_first = area(2, 3, 0) * area(2, 3, 1);
    if (of_second > 0 || of_first > 0) return Certainty::kNo;
    return of_second < 0 && of_first < 0 ? Certainty::kYes : Certainty::kUnknown;
  }

  int sign_of_volume(double value) const { return detail::certain_sign(value, volume_error_); }

  Certainty decide_part(const TimePart& part) {
    const int start = sign_of_volume(part.volume[0]), end = sign_of_volume(part.volume[3]);
    if (start != 0 && start == end && start == sign_of_volume(part.volume[1]) &&
        start == sign_of_volume(part.volume[2]))
      return Certainty::kNo;
    const Certainty shadows = shadows_meet(part);
    if (shadows == Certainty::kNo) return Certainty::kNo;
    if (shadows == Certainty::kYes && start * end < 0) return Certainty::kYes;
    if (--parts_left_ <= 0 || part.last_step - part.first_step < 2) return Certainty::kUnknown;
    Certainty result = Certainty::kNo;
    for (const TimePart& half : halves(part)) {
      const Certainty certainty = decide_part(half);
      if (certainty == Certainty::kYes) return certainty;
      if (certainty == Certainty::kUnknown) result = certainty;
    }
    return result;
  }
};

TimePart whole_time(const VolumeOverTime& volume) {
  const auto& c = volume.coefficient;
  return {0, kTimeSteps, {c[0], c[1], c[2], c[3]}};
}

std::optional<double> first_impact(ContinuousPair pair, const MovingPoints& points) {
  const VolumeOverTime volume = detail::volume_over_time(points);
  TimeHalving halving(pair, points, volume);
  TimePart part = whole_time(volume);
  if (!halving.meets(part)) return std::nullopt;
  while (part.last_step - part.first_step > 1) {
    const auto [first, second] = halves(part);
    part = halving.meets(first) ? first : second;
  }
  return static_cast<double>(part.first_step) / kTimeSteps;
}

}  // namespace

namespace detail {

bool vertex_meets_face_undecided(const MovingPoints& points, const VolumeOverTime& volume) {
  return TimeHalving(ContinuousPair::kVertexFace, points, volume).meets(whole_time(volume));
}

bool edge_meets_edge_undecided(const MovingPoints& points, const VolumeOverTime& volume) {
  return TimeHalving(ContinuousPair::kEdgeEdge, points, volume).meets(whole_time(volume));
}

}  // namespace detail

std::optional<double> vertex_face_impact(const MovingPoints& points) {
  if (!vertex_meets_face(points)) return std::nullopt;
  return first_impact(ContinuousPair::kVertexFace, points);
}

std::optional<double> edge_edge_impact(const MovingPoints& points) {
  if (!edge_meets_edge(points)) return std::nullopt;
  return first_impact(ContinuousPair::kEdgeEdge, points);
}

}  // namespace selvage
