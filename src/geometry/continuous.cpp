#include "selvage/geometry/continuous.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "geometry/exact/continuous_exact.h"
#include "geometry/motion_filter.h"

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

/// The part up to a step, by the same algorithm.
TimePart beginning(const TimePart& part, int last_step) {
  const auto& [a, b, c, d] = part.volume;
  const double s = static_cast<double>(last_step - part.first_step) / (part.last_step - part.first_step), r = 1 - s;
  const double ab = r * a + s * b, bc = r * b + s * c, cd = r * c + s * d;
  const double abc = r * ab + s * bc, bcd = r * bc + s * cd;
  return {part.first_step, last_step, {a, ab, abc, r * abc + s * bcd}};
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
/// the volume is not zero there, or if the projections of the sets on some coordinate plane do not meet; they do if the
/// volume changes its sign while the projections cross properly, for then some moment brings all into one plane.
class TimeHalving {
 public:
  TimeHalving(ContinuousPair pair, const MovingPoints& points, const VolumeOverTime& volume)
      : pair_(pair), points_(points) {
    double largest = 0;
    for (double c : volume.coefficient) largest = std::max(largest, std::abs(c));
    constexpr double kErrorOfParts = 0x1p-46;  // roundings of 2^-53: 3 a halving, of 20, and 9 a beginning, of 2
    constexpr double kLargestSum = 0x1p1000;   // sums of two do not overflow
    volume_error_ = largest < kLargestSum ? volume.error + kErrorOfParts * largest : HUGE_VAL;
    for (int i = 1; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        start_[i][k] = points.t0[i][k] - points.t0[0][k];
        end_[i][k] = points.t1[i][k] - points.t1[0][k];
      }
  }

  Certainty decide(const TimePart& part) {
    parts_left_ = kMaxParts;
    return is_doubtful(part) ? Certainty::kUnknown : decide_part(part);
  }

  /// Whether the sets meet, and in which step first.
  struct FirstMeeting {
    Certainty certainty;
    int step;
  };
  FirstMeeting first_meeting(const TimePart& part) {
    parts_left_ = kMaxParts;
    return is_doubtful(part) ? FirstMeeting{Certainty::kUnknown, 0} : first_in(part);
  }

  bool meets(const TimePart& all) {
    const Certainty certainty = decide(all);
    return certainty == Certainty::kUnknown ? meets_exactly(pair_, points_) : certainty == Certainty::kYes;
  }

 private:
  static constexpr int kMaxParts = 64;

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

  /// Whether the projections on the coordinate plane in which they are largest certainly meet properly or are apart.
  Certainty projections_meet(const TimePart& part) const {
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

  /// Whether the sets meet in the part, as far as that shows without halving it.
  Certainty decide_at_once(const TimePart& part) const {
    const int start = sign_of_volume(part.volume[0]), end = sign_of_volume(part.volume[3]);
    if (start != 0 && is_of_sign(start, part)) return Certainty::kNo;
    const Certainty projections = projections_meet(part);
    if (projections == Certainty::kNo) return Certainty::kNo;
    return projections == Certainty::kYes && start * end < 0 ? Certainty::kYes : Certainty::kUnknown;
  }

  /// As are pairs in one plane throughout, and pairs of bodies that lie on each other: whatever part begins when they
  /// do is doubtful, too, however small.
  bool is_doubtful(const TimePart& part) const {
    if (is_of_sign(0, part)) return projections_meet(part) != Certainty::kNo;
    return decide_at_once(beginning(part, part.first_step + 1)) == Certainty::kUnknown;
  }

  bool is_of_sign(int sign, const TimePart& part) const {
    return std::all_of(part.volume.begin(), part.volume.end(), [&](double v) { return sign_of_volume(v) == sign; });
  }

  bool may_halve(const TimePart& part) { return --parts_left_ > 0 && part.last_step - part.first_step >= 2; }

  Certainty decide_part(const TimePart& part) {
    const Certainty at_once = decide_at_once(part);
    if (at_once != Certainty::kUnknown || !may_halve(part)) return at_once;
    Certainty result = Certainty::kNo;
    for (const TimePart& half : halves(part)) {
      const Certainty certainty = decide_part(half);
      if (certainty == Certainty::kYes) return certainty;
      if (certainty == Certainty::kUnknown) result = certainty;
    }
    return result;
  }

  FirstMeeting first_in(const TimePart& part) {
    const Certainty at_once = decide_at_once(part);
    if (at_once == Certainty::kNo) return {at_once, 0};
    if (at_once == Certainty::kYes)
      if (const auto step = step_of_only_crossing(part)) return {at_once, *step};
    if (!may_halve(part)) return {Certainty::kUnknown, 0};
    for (const TimePart& half : halves(part))
      if (const FirstMeeting first = first_in(half); first.certainty != Certainty::kNo) return first;
    return {Certainty::kNo, 0};
  }

  /// The step in which a volume that changes its sign in the part does so first, if that is certain.
  std::optional<int> step_of_only_crossing(const TimePart& part) const {
    const int start = sign_of_volume(part.volume[0]);
    TimePart before{part.first_step, part.first_step, {}};
    TimePart until = part;
    while (until.last_step - before.last_step > 1) {
      const TimePart middle = beginning(part, before.last_step + (until.last_step - before.last_step) / 2);
      ((middle.volume[3] < 0) == (start < 0) ? before : until) = middle;
    }
    const bool is_first = before.last_step == part.first_step || is_of_sign(start, before);
    if (is_first && sign_of_volume(until.volume[3]) == -start) return before.last_step;
    return std::nullopt;
  }
};

TimePart whole_time(const VolumeOverTime& volume) {
  const auto& c = volume.coefficient;
  return {0, kTimeSteps, {c[0], c[1], c[2], c[3]}};
}

/// The steps up to a time, and more to make a power of two of them, which halves well; 0: none.
int steps_before(double time) {
  if (!(time > 0)) return 0;
  return time < 1 ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::ceil(time * kTimeSteps)))) : kTimeSteps;
}

std::optional<double> first_impact(ContinuousPair pair, const MovingPoints& points, double before) {
  const int last_step = steps_before(before);
  if (last_step == 0) return std::nullopt;
  const VolumeOverTime volume = detail::volume_over_time(points);
  TimeHalving halving(pair, points, volume);
  auto [certainty, step] = halving.first_meeting(beginning(whole_time(volume), last_step));
  if (certainty == Certainty::kNo) return std::nullopt;
  if (certainty == Certainty::kUnknown) {
    step = first_step_exactly(pair, points, last_step);
    if (step == last_step) return std::nullopt;
  }
  const double time = static_cast<double>(step) / kTimeSteps;
  return time < before ? std::optional(time) : std::nullopt;
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

std::optional<double> vertex_face_impact(const MovingPoints& points, double before) {
  if (detail::apart_on_an_axis<1>(points)) return std::nullopt;
  return first_impact(ContinuousPair::kVertexFace, points, before);
}

std::optional<double> edge_edge_impact(const MovingPoints& points, double before) {
  if (detail::apart_on_an_axis<2>(points)) return std::nullopt;
  return first_impact(ContinuousPair::kEdgeEdge, points, before);
}

bool vertex_meets_face(const MovingPoints& points) {
  if (detail::apart_on_an_axis<1>(points)) return false;
  const detail::VolumeOverTime volume = detail::volume_over_time(points);
  return !detail::never_zero(volume) && detail::vertex_meets_face_undecided(points, volume);
}

bool edge_meets_edge(const MovingPoints& points) {
  if (detail::apart_on_an_axis<2>(points)) return false;
  const detail::VolumeOverTime volume = detail::volume_over_time(points);
  return !detail::never_zero(volume) && detail::edge_meets_edge_undecided(points, volume);
}

}  // namespace selvage
