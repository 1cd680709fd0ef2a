#include <numbers>
#include <random>

#include "selvage/shapes/shapes.h"
#include "shapes/shape_arguments.h"
#include "shapes/shapes_implicit.h"
#include "shapes/stuffing/isosurface_stuffing.h"

namespace selvage {

namespace {

using std::numbers::pi;

/// Numbers in [0, 1) that depend on the seed alone (the distributions of the standard library may differ between
/// platforms).
class UnitRandom {
 public:
  explicit UnitRandom(unsigned seed) : engine_(seed) {}
  double next() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double next_signed() { return 2 * next() - 1; }

 private:
  std::mt19937_64 engine_;
};

void check_resolves(double cell, double thinnest_radius) {
  const double coarsest = coarsest_cell(thinnest_radius);
  if (!(cell <= coarsest)) {
    throw Error("cell", fmt::format("{} is too coarse for arms of radius {:.3g}", cell, thinnest_radius),
                fmt::format("use at most {:.3g}", coarsest));
  }
}

/// Directions spread evenly over the sphere (a Fibonacci spiral), each moved a little.
std::vector<Vec3> spread_directions(int count, unsigned seed) {
  UnitRandom random(seed);
  const double jitter = 0.12 * std::sqrt(4 * pi / count);
  std::vector<Vec3> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, angle = pi * (3 - std::sqrt(5.0)) * i;
    const double ring = std::sqrt(1 - z * z);
    const double dx = random.next_signed(), dy = random.next_signed(), dz = random.next_signed();
    directions.push_back(
        (Vec3(ring * std::cos(angle), ring * std::sin(angle), z) + jitter * Vec3(dx, dy, dz) / std::sqrt(3.0))
            .normalized());
  }
  return directions;
}

/// Middle line of an octopus's arm from its head (u = 0) to its tip (u = 1), for a size of 1: out and down, then up,
/// swaying to the side.
struct OctopusArm {
  double heading, droop, sway, phase;

  Vec3 point(double u) const {
    const double out = 0.12 + 0.82 * u;
    const double side = heading + sway * u * std::sin(2.2 * pi * u + phase);
    const double up = -0.06 - droop * std::sin(pi * std::min(1.0, 1.15 * u)) + 0.16 * u * u * u;
    return {out * std::cos(side), out * std::sin(side), up};
  }
};

/// Radii of an octopus of size 1. The tips are thinned less than the rest, for the thinnest place asks for the cell.
struct OctopusRadii {
  explicit OctopusRadii(double slenderness)
      : crown(0.28 / slenderness),
        neck(0.2 / slenderness),
        tip(0.055 / std::sqrt(slenderness)),
        root(std::max(0.115 / slenderness, tip)) {}
  double crown, neck, tip, root;

  double arm(double u) const { return root - (root - tip) * u; }
};

void check_slenderness(double slenderness, double most) {
  if (slenderness >= 1 && slenderness <= most) return;
  throw Error("slenderness", fmt::format("{} is out of range", slenderness), fmt::format("use 1 to {}", most));
}

}  // namespace

double squishy_tip_radius(double radius, int tentacles) {
  // Neighbours stand about `spacing` apart, at least 0.6 of it.
  const double spacing = radius * std::min(1.0, std::sqrt(4 * pi / tentacles));
  return 0.22 * spacing;
}

double octopus_tip_radius(double size, double slenderness) {
  return size * OctopusRadii(slenderness).tip;
}

IndexedMesh make_ball(double radius, double cell) {
  check_positive("radius", radius);
  check_positive("cell", cell);
  ImplicitSolid ball;
  ball.parts.push_back({Vec3::Zero(), Vec3::Zero(), radius, radius});
  ball.body_count = 1;
  return stuff_isosurface(ball, cell);
}

IndexedMesh make_squishy_ball(double radius, int tentacles, double cell, unsigned seed, double slenderness) {
  check_positive("radius", radius);
  check_positive("cell", cell);
  check_slenderness(slenderness, 10);
  if (tentacles < 1 || tentacles > 100000) {
    throw Error("tentacles", fmt::format("{} is out of range", tentacles), "use a number from 1 to 100000");
  }
  const double tip = squishy_tip_radius(radius, tentacles), root = 1.15 * tip;
  check_resolves(cell, tip);
  ImplicitSolid solid;
  solid.parts.push_back({Vec3::Zero(), Vec3::Zero(), radius, radius});
  solid.body_count = 1;
  solid.blend = 0.5 * root;
  for (const Vec3& direction : spread_directions(tentacles, seed)) {
    solid.parts.push_back({0.9 * radius * direction, ((1 + slenderness) * radius - tip) * direction, root, tip});
  }
  return stuff_isosurface(solid, cell);
}

IndexedMesh make_octopus(double size, double cell, unsigned seed, double slenderness) {
  check_positive("size", size);
  check_positive("cell", cell);
  check_slenderness(slenderness, 4);
  check_resolves(cell, octopus_tip_radius(size, slenderness));
  const OctopusRadii radii(slenderness);
  const Vec3 crown = size * Vec3(0, -0.06, 0.02 + 0.4 / slenderness);
  ImplicitSolid solid;
  solid.parts.push_back({size * Vec3(0, 0, 0.02), crown, radii.neck * size, radii.crown * size});
  solid.body_count = 1;
  solid.blend = 0.1 * size / slenderness;
  UnitRandom random(seed);
  constexpr int kArms = 8, kJoints = 24;
  for (int arm = 0; arm < kArms; ++arm) {
    OctopusArm line{2 * pi * (arm + 0.5) / kArms, 0, 0, 0};
    line.droop = 0.14 + 0.08 * random.next();
    line.sway = 0.14 * random.next_signed();
    line.phase = 2 * pi * random.next();
    for (int joint = 0; joint < kJoints; ++joint) {
      const double u = joint / double{kJoints}, next = (joint + 1) / double{kJoints};
      solid.parts.push_back(
          {size * line.point(u), size * line.point(next), size * radii.arm(u), size * radii.arm(next)});
    }
  }
  return stuff_isosurface(solid, cell);
}

}  // namespace selvage
