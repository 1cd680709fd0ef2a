#include "selvage/shapes/poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "mesh/position_extent.h"
#include "selvage/core/error.h"
#include "shapes/plane_curve.h"

namespace selvage {

namespace {

using std::numbers::pi;

void check_finite(std::string_view name, double value) {
  if (!std::isfinite(value)) throw Error(name, fmt::format("{} is not finite", value), "use a finite number");
}

void check_axis(int axis) {
  if (axis < 0 || axis > 2) throw Error("axis", fmt::format("there is no axis {}", axis), "use 0, 1 or 2");
}

/// A mesh seen along the axis that a pose bends: its length, and half its thickness in the direction it bends to.
struct Bar {
  PositionExtent<3> extent;
  int axis, across;
  double length, half_thickness;

  Vec3 middle() const { return (extent.lower + extent.upper) / 2; }
};

Bar bar_of(std::span<const Vec3> positions, int axis) {
  check_axis(axis);
  if (positions.empty()) throw Error("", "there are no vertices to pose", "give a mesh with vertices");
  Bar bar{extent_of<3>(positions), axis, (axis + 1) % 3, 0, 0};
  const Vec3 size = bar.extent.upper - bar.extent.lower;
  // The thinner axis; among equals the next one, whatever rounding says.
  if (size[(axis + 2) % 3] < 0.999 * size[bar.across]) bar.across = (axis + 2) % 3;
  bar.length = size[axis];
  bar.half_thickness = size[bar.across] / 2;
  if (!(bar.length > 0)) {
    throw Error("axis", fmt::format("the mesh has no length along axis {}", axis), "use another axis");
  }
  return bar;
}

/// Lays the bar along the plane curve with tangent `angle(s)`, middle on the origin of the plane; `largest_curvature`
/// is that of the curve.
template <typename Angle>
void lay_along(std::span<Vec3> positions, const Bar& bar, double largest_curvature, Angle angle) {
  if (!(largest_curvature * bar.half_thickness < 1)) {
    throw Error("pose",
                fmt::format("the mesh, {:.3g} thick, would turn inside out in a bend of radius {:.3g}",
                            2 * bar.half_thickness, 1 / largest_curvature),
                "bend it less, along a longer axis, or use a thinner mesh");
  }
  const PlaneCurve curve(bar.length, angle);
  const Vec2 origin = curve.point(bar.length / 2);
  const Vec3 middle = bar.middle();
  parallel_for(static_cast<std::int64_t>(positions.size()), kGrain, [&](std::int64_t i) {
    Vec3& p = positions[i];
    const double s = p[bar.axis] - bar.extent.lower[bar.axis], u = p[bar.across] - middle[bar.across];
    const Vec2 tangent = curve.tangent(s);
    const Vec2 place = curve.point(s) - origin + u * Vec2(-tangent[1], tangent[0]);
    p[bar.axis] = middle[bar.axis] + place[0];
    p[bar.across] = middle[bar.across] + place[1];
  });
}

}  // namespace

void pose_twist(std::span<Vec3> positions, int axis, double turns) {
  check_finite("turns", turns);
  const Bar bar = bar_of(positions, axis);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec3 middle = bar.middle();
  parallel_for(static_cast<std::int64_t>(positions.size()), kGrain, [&](std::int64_t i) {
    Vec3& p = positions[i];
    const double angle = 2 * pi * turns * (p[axis] - middle[axis]) / bar.length;
    const double x = p[u] - middle[u], y = p[v] - middle[v];
    p[u] = middle[u] + std::cos(angle) * x - std::sin(angle) * y;
    p[v] = middle[v] + std::sin(angle) * x + std::cos(angle) * y;
  });
}

void pose_bend(std::span<Vec3> positions, int axis, double turns) {
  check_finite("turns", turns);
  const Bar bar = bar_of(positions, axis);
  const double curvature = 2 * pi * turns / bar.length;
  lay_along(positions, bar, std::abs(curvature), [=](double s) { return curvature * (s - bar.length / 2); });
}

void pose_fold(std::span<Vec3> positions, int axis, double angle) {
  check_finite("angle", angle);
  const Bar bar = bar_of(positions, axis);
  // The curvature rises to twice the mean in the middle of the crease; there the thickness takes at most 0.7 of it.
  constexpr double kLargestBend = 0.7;
  const double crease = std::max(2 * std::abs(angle) * bar.half_thickness / kLargestBend, 0.1 * bar.length);
  if (!(crease < bar.length)) {
    throw Error("pose",
                fmt::format("a crease as wide as {:.3g} does not fit into a length of {:.3g}", crease, bar.length),
                "fold by a smaller angle, along a longer axis, or use a thinner mesh");
  }
  lay_along(positions, bar, 2 * std::abs(angle) / crease, [=](double s) {
    const double x = std::clamp((s - bar.length / 2) / crease, -0.5, 0.5);
    return angle * (x + std::sin(2 * pi * x) / (2 * pi));
  });
}

void pose_self_crossing(std::span<Vec3> positions, int axis, int crossings) {
  if (crossings < 1 || crossings > 1000) {
    throw Error("crossings", fmt::format("{} is out of range", crossings), "use a number from 1 to 1000");
  }
  const Bar bar = bar_of(positions, axis);
  // Loops that lean forward, slack at both ends: the curve turns once a loop, faster in its middle.
  constexpr double kLean = 0.8;
  const double rate = 2 * pi * crossings / bar.length;
  lay_along(positions, bar, rate * (1 + kLean), [=](double s) { return rate * s - kLean * std::sin(rate * s); });
}

void pose_overlap(std::span<Vec3> positions, Index first, const Vec3& offset) {
  if (first < 0 || static_cast<std::size_t>(first) > positions.size()) {
    throw Error(fmt::format("vertex {}", first), fmt::format("the mesh has {} vertices", positions.size()),
                "use the first vertex of an object");
  }
  for (int axis = 0; axis < 3; ++axis) check_finite("offset", offset[axis]);
  for (Vec3& p : positions.subspan(first)) p += offset;
}

}  // namespace selvage
