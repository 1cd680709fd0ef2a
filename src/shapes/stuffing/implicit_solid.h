#pragma once

#include "selvage/core/types.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage {

/// All balls whose middle runs from `begin` to `end` while their radius goes from one to the other: a ball, a capsule,
/// a tapered arm.
struct RoundCone {
  Vec3 begin, end;
  double begin_radius, end_radius;

  /// Distance of p below the surface, negative outside, exact there; changes no faster than p moves.
  double depth(const Vec3& p) const {
    const Vec3 axis = end - begin, to_point = p - begin;
    const double length = axis.norm();
    if (!(length > std::abs(end_radius - begin_radius))) {
      return std::max(begin_radius - to_point.norm(), end_radius - (p - end).norm());
    }
    const double along = axis.dot(to_point) / length;
    const double off = std::sqrt(std::max(0.0, to_point.squaredNorm() - along * along));
    // The ball that comes nearest to p is met where the surface's slope meets the axis.
    const double taper = (end_radius - begin_radius) / length;
    const double t = std::clamp((along + taper * off / std::sqrt(1 - taper * taper)) / length, 0.0, 1.0);
    return begin_radius + t * (end_radius - begin_radius) - (to_point - t * axis).norm();
  }

  /// An upper bound of the volume.
  double volume() const {
    const double a = begin_radius, b = end_radius, largest = std::max(a, b);
    return std::numbers::pi *
           ((a * a + a * b + b * b) / 3 * (end - begin).norm() + 4.0 / 3 * largest * largest * largest);
  }
};

/// Solid made of round cones: arms that flow into a body.
///
/// Its depth is positive inside and changes no faster than the point moves, so that one value bounds a neighbourhood.
struct ImplicitSolid {
  std::vector<RoundCone> parts;
  Index body_count = 0;  ///< the first parts are the body, the others its arms
  double blend = 0;      ///< width of the seam between body and arms [m]

  /// Depth of a point that is within `blend` of no part but those listed.
  double depth(const Vec3& p, std::span<const Index> nearby) const {
    double body = -kFar, arms = -kFar;
    for (Index part : nearby) {
      double& side = part < body_count ? body : arms;
      side = std::max(side, parts[part].depth(p));
    }
    const double overlap = blend - std::abs(body - arms);
    const double seam = overlap > 0 ? overlap * overlap / (4 * blend) : 0;
    return std::max(body, arms) + seam;
  }

  double volume() const {
    double sum = 0;
    for (const RoundCone& part : parts) sum += part.volume();
    return sum;
  }

 private:
  static constexpr double kFar = 1e300;
};

}  // namespace selvage
