#pragma once

#include "selvage/core/types.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage {

/// A point of a curve in the plane, and the unit vector to its left.
struct CurvePoint {
  Vec2 point, left;
};

/// A straight line along x that bends left by `angle` over the arc lengths from -length / 2 to length / 2.
inline CurvePoint bent_line(double s, double angle, double length) {
  const double on_arc = std::clamp(s, -length / 2, length / 2);
  const double curvature = angle / length, heading = curvature * on_arc;
  const Vec2 tangent(std::cos(heading), std::sin(heading));
  // Half-angle forms: precise for a straight line, too.
  const double half = heading / 2, chord = half == 0 ? on_arc : on_arc * std::sin(half) / half;
  return {chord * Vec2(std::cos(half), std::sin(half)) + (s - on_arc) * tangent, Vec2(-tangent[1], tangent[0])};
}

/// How far folds move a place at `phase` (one fold a turn): along the surface, as part of a turn, and out of it, from
/// -1 to 1. Loops of the folds lean over their necks more, the larger the tightness; above 1 the necks pass through
/// themselves.
struct Fold {
  double along, out;
};

inline Fold fold_at(double phase, double tightness) {
  const double angle = 2 * std::numbers::pi * phase;
  return {-tightness / (4 * std::numbers::pi) * std::sin(2 * angle), std::cos(angle)};
}

/// From 0 to 1 as x goes from `from` to `to`, smoothly.
inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Waves of many lengths and directions over the plane, the shorter the lower: `steepness` is that of each.
///
/// @param in_plane  how far the waves also move places along the plane, as part of their height
inline Vec3 wave_sum(const Vec2& p, int count, double longest, double steepness, double in_plane, double time) {
  constexpr double kGoldenAngle = 2.399963229728653;
  Vec3 sum = Vec3::Zero();
  double length = longest;
  for (int i = 0; i < count; ++i, length *= 0.83) {
    const double heading = kGoldenAngle * i + 0.3, drift = kGoldenAngle * 1.7 * i + 0.9;
    const double angle = 2 * std::numbers::pi / length * (p[0] * std::cos(heading) + p[1] * std::sin(heading)) +
                         1.3 * i * i + (1 + 0.37 * i) * time;
    const double height = steepness * length / (2 * std::numbers::pi);
    sum += height * Vec3(in_plane * std::cos(drift) * std::cos(angle), in_plane * std::sin(drift) * std::cos(angle),
                         std::sin(angle));
  }
  return sum;
}

}  // namespace selvage
