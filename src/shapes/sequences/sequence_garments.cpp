#include "shapes/sequences/sequence_curves.h"
#include "shapes/sequences/sequence_maps.h"
#include "shapes/sequences/sequence_material.h"

namespace selvage {

namespace {

using std::numbers::pi;

/// A trouser leg around a leg that hangs from the hip, is lifted forward and bent back at the knee.
Vec3 place_leg(double u, double v, double lift, double knee, double time) {
  constexpr double kThigh = 0.46, kLeg = 0.92, kBend = 0.17, kFolds = 14;
  const double around = 2 * pi * u;
  // Wide, narrower at the ankle, where it bunches.
  const double bunched = smooth_step(0.62, 0.95, v);
  const Fold fold = fold_at(kFolds * v + 0.17 * std::sin(around + 5 * time) + 0.05 * std::sin(4 * around + 1),
                            bunched * (0.75 + 0.45 * std::sin(2 * around + 3 * time)));
  const double radius = 0.125 - 0.045 * v + 0.004 * std::sin(5 * around + 10 * v) + 0.009 * bunched * fold.out;
  const CurvePoint hip = bent_line(-kThigh, -knee, kBend);
  const CurvePoint c = bent_line(kLeg * (v + fold.along / kFolds) - kThigh, -knee, kBend);
  // In the plane of forward and up; without lift the thigh points down.
  const Vec2 place =
      Eigen::Rotation2Dd(lift - knee / 2 - pi / 2) * Vec2(c.point - hip.point + radius * std::cos(around) * c.left);
  return {radius * std::sin(around), place[0], 0.9 + place[1]};
}

Vec3 place_jacket(double u, double v, double time) {
  const double around = 2 * pi * u, belt = std::exp(-std::pow((v - 0.55) / 0.12, 2));
  // Folds hang from the shoulders and are gathered by the belt; the hem swings with the kick.
  const double turn = u + 0.12 * std::sin(pi * time) * (v - 0.3);
  const Fold fold =
      fold_at(24 * u + 0.4 * std::sin(4 * v + 2 * time) + 0.15 * std::sin(5 * around + 3 * v), 0.55 + 0.6 * belt);
  const double hem = smooth_step(0.6, 1, v), radius = 0.21 - 0.05 * belt + 0.12 * hem;
  const double r = radius + (0.006 + 0.012 * belt + 0.01 * hem) * fold.out;
  const double angle = around + 2 * pi * (turn - u) + 2 * pi * fold.along / 24;
  return {1.1 * r * std::cos(angle), 0.8 * r * std::sin(angle) - 0.05 * hem * std::sin(2 * pi * time),
          1.5 - 0.5 * v + 0.004 * std::sin(7 * around + 2) + 0.02 * std::sin(2 * around + 6 * time) * hem};
}

}  // namespace

Vec3 place_karate(const Vec3& material, double time) {
  const double u = material[0], v = material[1];
  if (material[2] == 0) return place_jacket(u, v, time);
  if (material[2] == 1) {
    const Vec3 standing = place_leg(u, v, 0.15, 0.35 + 0.2 * std::sin(pi * time), time);
    return standing + Vec3(0.14, 0, 0);
  }
  // The knee comes up bent, then the shin snaps forward.
  const double lift = 1.7 * smooth_step(0, 0.6, time);
  const double knee = 0.2 + 1.9 * (smooth_step(0, 0.45, time) - smooth_step(0.6, 1, time));
  return place_leg(u, v, lift, knee, time + 0.5) - Vec3(0.14, 0, 0);
}

Vec3 place_shirt(const Vec3& material, double time) {
  constexpr double kUnit = 0.036, kBox = 0.14;
  const Vec2 flat(kUnit * material[0], kUnit * (material[1] - kShirtHeight / 2));
  const double stuffed = smooth_step(0, 1, time);
  Vec3 p = Vec3(flat[0], flat[1], 0.014 * material[2]);
  p += stuffed * wave_sum(flat, 8, 0.5, 0.5, 0.5, 1.5 * time);
  // Walls that close in turn back what would pass them.
  const Vec3 turned = Eigen::AngleAxisd(0.5, Vec3(0.3, 0.5, 0.8).normalized()) * p;
  Vec3 place;
  for (int axis = 0; axis < 3; ++axis)
    place[axis] = (1 - stuffed) * turned[axis] + stuffed * kBox * std::sin(turned[axis] / kBox);
  return place;
}

Vec3 place_flamenco(const Vec3& material, double time) {
  const double u = material[0], v = material[1], around = 2 * pi * u;
  const int ruffle = static_cast<int>(material[2]);
  // Down the skirt from the bodice, 0 to 1; a ruffle is sewn on along a ring and hangs before the skirt.
  const double ring = ruffle == 0 ? 0 : 0.4 + 0.2 * ruffle - 0.15, h = ruffle == 0 ? v : ring + 0.2 * v;
  const double flare = 0.42 + 0.1 * std::sin(2 * pi * time), lag = -h * h * (0.7 + 0.25 * std::cos(2 * pi * time));
  const double pleats = 11, hang = smooth_step(0.25, 1, h);
  const Fold pleat = fold_at(pleats * u + 0.1 * std::sin(around + 6 * time), 0.7 * hang);
  double radius = 0.14 - 0.05 * std::exp(-std::pow((h - 0.28) / 0.1, 2)) + flare * hang * h;
  radius += 0.035 * hang * pleat.out;
  double angle = around + 2 * pi * pleat.along / pleats;
  double height = 1.35 - 1.25 * h + 0.15 * flare * hang * h;
  if (ruffle > 0) {
    const double ruffles = 28 + 4 * ruffle, loose = smooth_step(0, 1, v);
    const Fold fold = fold_at(ruffles * u + 0.15 * std::sin(3 * around + 8 * time + ruffle),
                              loose * (0.85 + 0.3 * std::sin(5 * around + 5 * time)));
    radius += 0.004 + 0.03 * v + 0.022 * loose * fold.out;
    angle += 2 * pi * fold.along / ruffles;
    height += 0.01 * loose * std::sin(7 * around + 4 * time);
  }
  angle += 2 * pi * time + lag;
  return {radius * std::cos(angle), radius * std::sin(angle), height};
}

}  // namespace selvage
