#include "shapes/rod_curves.h"

#include "shapes/open_knots.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace selvage {

namespace {

using std::numbers::pi;

/// Windings of a coil do not touch: they are this many rod radii apart, middle to middle.
constexpr double kCoilPitch = 3;

/// Height of a long coil over the radius of its windings.
constexpr double kCoilSlenderness = 36;

/// The nested knot: how far its strands stay from the trefoil that they follow, and half-turns around it in one round
/// (an odd number, so that the second round starts opposite to the first).
constexpr double kStrandOffset = 0.42;
constexpr int kStrandHalfTurns = 13;

Vec3 trefoil_point(double t) {
  return {std::sin(t) + 2 * std::sin(2 * t), std::cos(t) - 2 * std::cos(2 * t), -1.3 * std::sin(3 * t)};
}

Vec3 nested_knot_point(double t) {
  const Vec3 d1(std::cos(t) + 4 * std::cos(2 * t), -std::sin(t) + 4 * std::sin(2 * t), -3.9 * std::cos(3 * t));
  const Vec3 d2(-std::sin(t) - 8 * std::sin(2 * t), -std::cos(t) + 8 * std::cos(2 * t), 11.7 * std::sin(3 * t));
  const Vec3 tangent = d1.normalized();
  const Vec3 normal = (d2 - tangent.dot(d2) * tangent).normalized();
  const double turn = 0.5 * kStrandHalfTurns * t;
  return trefoil_point(t) + kStrandOffset * (std::cos(turn) * normal + std::sin(turn) * tangent.cross(normal));
}

/// A curve by its parameter, in its own scale: `scale` brings it to the length asked for.
struct ParametricCurve {
  RodCurve kind;
  double end = 1;
  double coil_radius = 0, coil_rise = 0;  ///< helix: rise per radian
  double scale = 1;

  Vec3 point(double t) const {
    switch (kind) {
      case RodCurve::kTrefoil:
        return scale * trefoil_point(t);
      case RodCurve::kNestedKnot:
        return scale * nested_knot_point(t);
      case RodCurve::kCoil:
        return scale * Vec3(coil_radius * std::cos(t), coil_radius * std::sin(t), coil_rise * t);
      case RodCurve::kOverhand:
        return scale * overhand_point(t);
      case RodCurve::kNestedOverhand:
        return scale * nested_overhand_point(t);
      default:
        return scale * Vec3(t, 0, 0);
    }
  }
  Vec3 tangent(double t) const {
    const double step = 1e-5 * std::min(end, 1.0);
    return (point(t + step) - point(t - step)).normalized();
  }
};

/// Arc length up to equal steps of the parameter, and its inverse.
class ArcLength {
 public:
  explicit ArcLength(const ParametricCurve& curve) : end_(curve.end), lengths_(kSteps + 1, 0.0) {
    Vec3 last = curve.point(0);
    for (int i = 1; i <= kSteps; ++i) {
      const Vec3 next = curve.point(end_ * i / kSteps);
      lengths_[i] = lengths_[i - 1] + (next - last).norm();
      last = next;
    }
  }
  double total() const { return lengths_.back(); }
  double parameter(double length) const {
    const auto above = std::upper_bound(lengths_.begin(), lengths_.end() - 1, length);
    const auto i = std::max<std::ptrdiff_t>(above - lengths_.begin(), 1);
    return end_ / kSteps * (i - 1 + (length - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]));
  }

 private:
  static constexpr int kSteps = 1 << 15;
  double end_;
  std::vector<double> lengths_;
};

/// The curve at the length asked for. A coil's radius follows from rod and length: slender, so that it can be bent far.
ParametricCurve curve_of_length(RodCurve kind, double length, double radius) {
  ParametricCurve curve{kind};
  if (kind == RodCurve::kStraight) {
    curve.end = length;
    return curve;
  }
  if (kind == RodCurve::kCoil) {
    curve.coil_radius = std::max(2.5 * radius, std::sqrt(kCoilPitch * radius * length / (2 * kCoilSlenderness * pi)));
    curve.coil_rise = kCoilPitch * radius / (2 * pi);
    curve.end = length / std::hypot(curve.coil_radius, curve.coil_rise);
    return curve;
  }
  if (is_closed(kind)) curve.end = kind == RodCurve::kNestedKnot ? 4 * pi : 2 * pi;
  curve.scale = length / ArcLength(curve).total();
  return curve;
}

/// Any unit vector at a right angle.
Vec3 any_normal(const Vec3& tangent) {
  int axis = 0;
  tangent.cwiseAbs().minCoeff(&axis);
  return (Vec3::Unit(axis) - tangent[axis] * tangent).normalized();
}

/// The normal of `from`, carried to `to` by two reflections.
Vec3 carry_normal(const RodSection& from, const RodSection& to) {
  const Vec3 step = to.point - from.point;
  const double squared_step = step.squaredNorm();
  const Vec3 normal = from.normal - 2 / squared_step * step.dot(from.normal) * step;
  const Vec3 tangent = from.tangent - 2 / squared_step * step.dot(from.tangent) * step;
  const Vec3 turn = to.tangent - tangent;
  const double squared_turn = turn.squaredNorm();
  const Vec3 carried = squared_turn > 0 ? Vec3(normal - 2 / squared_turn * turn.dot(normal) * turn) : normal;
  return (carried - to.tangent.dot(carried) * to.tangent).normalized();
}

void set_frames(std::vector<RodSection>& sections, bool closed) {
  sections.front().normal = any_normal(sections.front().tangent);
  for (std::size_t i = 1; i < sections.size(); ++i) sections[i].normal = carry_normal(sections[i - 1], sections[i]);
  double missing = 0;
  if (closed) {
    const RodSection& first = sections.front();
    const Vec3 carried = carry_normal(sections.back(), first);
    missing = std::atan2(carried.cross(first.normal).dot(first.tangent), carried.dot(first.normal));
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    RodSection& section = sections[i];
    const double turn = missing * static_cast<double>(i) / static_cast<double>(sections.size());
    section.normal = std::cos(turn) * section.normal + std::sin(turn) * section.tangent.cross(section.normal);
    section.binormal = section.tangent.cross(section.normal);
  }
}

}  // namespace

bool is_closed(RodCurve curve) {
  return curve == RodCurve::kTrefoil || curve == RodCurve::kNestedKnot;
}

std::vector<RodSection> rod_sections(RodCurve kind, double length, double radius, Index count) {
  const ParametricCurve curve = curve_of_length(kind, length, radius);
  const ArcLength arc(curve);
  const bool closed = is_closed(kind);
  std::vector<RodSection> sections(count);
  for (Index i = 0; i < count; ++i) {
    const double t = arc.parameter(arc.total() * i / (closed ? count : count - 1));
    sections[i].point = curve.point(t);
    sections[i].tangent = curve.tangent(t);
  }
  set_frames(sections, closed);
  return sections;
}

double fewest_layers(RodCurve curve) {
  switch (curve) {
    case RodCurve::kTrefoil:
    case RodCurve::kNestedKnot:
      return 64;
    case RodCurve::kOverhand:
      return 160;
    case RodCurve::kNestedOverhand:
      return 640;
    default:
      return 1;
  }
}

std::vector<RodSection> circle_sections(double radius, Index count) {
  std::vector<RodSection> sections(count);
  for (Index i = 0; i < count; ++i) {
    const double angle = 2 * pi * i / count;
    const Vec3 outward(std::cos(angle), std::sin(angle), 0);
    sections[i] = {radius * outward, Vec3(-outward[1], outward[0], 0), Vec3(0, 0, 1), outward};
  }
  return sections;
}

double largest_rod_radius(RodCurve kind, double length) {
  if (kind == RodCurve::kStraight || kind == RodCurve::kCoil) return std::numeric_limits<double>::infinity();
  const std::vector<RodSection> samples = rod_sections(kind, length, 0, 1024);
  double reach = length;
  for (const RodSection& at : samples) {
    for (const RodSection& other : samples) {
      const Vec3 apart = other.point - at.point;
      // Federer: the ball that touches the curve at `at` and runs through `other`.
      const double off_tangent = (apart - at.tangent.dot(apart) * at.tangent).norm();
      if (off_tangent > 0) reach = std::min(reach, apart.squaredNorm() / (2 * off_tangent));
    }
  }
  return reach;
}

}  // namespace selvage
