#include "shapes/sequences/sequence_curves.h"
#include "shapes/sequences/sequence_maps.h"

namespace selvage {

namespace {

using std::numbers::pi;

/// 0 far below 0, x far above it; rounded over the width.
double rounded_ramp(double x, double width) {
  return x > 0 ? x + width * std::log1p(std::exp(-x / width)) : width * std::log1p(std::exp(x / width));
}

}  // namespace

Vec3 place_pipe(const Vec3& material, double time) {
  constexpr double kRadius = 0.1, kBow = 1.3, kTip = 0.43, kTail = 0.8;
  const double around = 2 * pi * material[0], s = -kBow / 2 - kTip + (kTip + kBow + kTail) * material[1];
  const CurvePoint c = bent_line(s, 2 + 2.45 * smooth_step(0, 1, time), kBow);
  // A soft pipe: dented a little, and flat where it lies.
  const double radius = kRadius * (1 + 0.03 * std::sin(3 * around + 9 * s + 2 * time));
  const double up = radius * std::sin(around), height = kRadius + (up < 0 ? 0.9 * up : up) + 0.01 * s * s;
  const Vec2 place = c.point + radius * std::cos(around) * c.left;
  return {place[0], place[1], height};
}

Vec3 place_funnel(const Vec3& material, double time) {
  constexpr double kThroat = 0.09, kEdge = 0.05, kPleats = 9;
  const Vec2 flat(material[0] - 0.5, material[1] - 0.5);
  const double s = flat.norm(), fallen = -0.25 + 0.8 * time;
  // Along the wall, above or below the throat; what is above lies on a cone, what is below hangs in the spout.
  const double above = rounded_ramp(s - fallen, kEdge), at_centre = rounded_ramp(-fallen, kEdge);
  const double narrow = 1 - smooth_step(-0.35, 0.05, -fallen);
  const double open = s, closed = kThroat * std::tanh(s / kThroat) + 0.75 * (above - at_centre);
  const double radius = (1 - narrow) * open + narrow * std::min(closed, s);
  const double height = -fallen + (1 - 0.3) * (s - fallen) * narrow - 0.35 * above * narrow;
  if (s == 0) return {0, 0, height};
  // Cloth that finds no room around the axis goes into pleats.
  const double excess = std::max(1.0, s / radius);
  const double depth = 0.55 * radius * std::sqrt(excess * excess - 1) / kPleats;
  const double turn = std::atan2(flat[1], flat[0]) / (2 * pi);
  const double sway = 0.08 * std::sin(2 * pi * (3 * turn + time)) + 0.05 * std::sin(2 * pi * 2 * turn + 25 * s);
  const Fold fold = fold_at(kPleats * turn + sway, 1.5 * (1 - 1 / excess) + 0.8 * (excess - 1) / (excess + 2));
  const double angle = 2 * pi * (turn + fold.along / kPleats), r = radius + depth * fold.out;
  return {r * std::cos(angle), r * std::sin(angle), height};
}

Vec3 place_waves(const Vec3& material, double time) {
  const Vec2 flat = 2 * material.head<2>();
  return Vec3(flat[0], flat[1], 0) + wave_sum(flat, 6, 0.9, 0.12, 0.1, 2 * pi * time);
}

Vec3 place_crumple(const Vec3& material, double time) {
  const Vec2 flat = 2 * material.head<2>();
  return Vec3(flat[0], flat[1], 0) + wave_sum(flat, 12, 0.8, 0.53, 0.85, time);
}

}  // namespace selvage
