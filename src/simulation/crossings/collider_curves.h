#pragma once

#include "selvage/simulation/collider.h"

#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace selvage {

/// A straight line or an arc on a collider, by a parameter that runs from `first` to `last`.
struct ColliderCurve {
  Vec3 middle, u, v;  ///< arc: middle + cos(t) u + sin(t) v; straight line: middle + t u
  double first, last;
  bool is_arc;

  Vec3 point(double t) const {
    return is_arc ? Vec3(middle + std::cos(t) * u + std::sin(t) * v) : Vec3(middle + t * u);
  }
  double length() const { return u.norm() * (last - first); }
};

/// What of a collider, in its own coordinates, can stand in a body whose vertices are all outside.
struct ColliderFeatures {
  std::vector<Vec3> points;
  std::vector<ColliderCurve> curves;
  std::vector<std::array<Vec3, 3>> faces;
};

/// Corners, edges and faces of a mesh, the rim of a bowl, ends and lines along the side of a cylinder, rings of a
/// sphere. A plane and a box, which is a container, have none: what crosses them has vertices on their far side. Faces
/// are there for a wall or a disk all through a body: none of its edges is inside.
///
/// An edge at which a mesh is flat or hollow is left out. So is the side of a cylinder, or a sphere, of more than
/// kMaxRoundness spacings in radius: a body on it touches it nearly as a plane.
///
/// @param spacing  between lines and rings of round shapes, at most [m]
ColliderFeatures find_features(const Collider& collider, double spacing);

/// Points of a curve that lie near a box, at most `spacing` apart: all within the box, and a few beside it. The ends of
/// the curve are not among them. O(points + log(length / spacing)).
/// @param emit  called with each, in order
template <typename Emit>
void sample_curve(const ColliderCurve& curve, double first, double last, const Eigen::AlignedBox3d& box, double spacing,
                  Emit&& emit) {
  const double middle = 0.5 * (first + last), reach = 0.5 * curve.u.norm() * (last - first);
  const Vec3 point = curve.point(middle);
  if (box.squaredExteriorDistance(point) > reach * reach) return;
  if (2 * reach <= spacing) return emit(point);
  sample_curve(curve, first, middle, box, spacing, emit);
  sample_curve(curve, middle, last, box, spacing, emit);
}

}  // namespace selvage
