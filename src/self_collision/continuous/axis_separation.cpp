#include "self_collision/continuous/axis_separation.h"

#include "self_collision/surface/moving_points.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Relative error of a dot product of three terms, and of what is added to it here.
constexpr double kDotError = 0x1p-49;
/// Thickness is decided up to rounding.
constexpr double kThicknessSlack = 1 + 0x1p-40;

/// Range of points along an axis over the step, rounded outward.
struct Range {
  double least = HUGE_VAL, most = -HUGE_VAL;

  void add(const Vec3& axis, const Vec3& p) {
    const double along = axis.dot(p), error = kDotError * axis.cwiseAbs().dot(p.cwiseAbs());
    least = std::min(least, along - error);
    most = std::max(most, along + error);
  }
};

class AxisTest {
 public:
  AxisTest(const MovingPoints& points, int first_count, double thickness)
      : points_(points), first_count_(first_count), thickness_(thickness) {}

  /// Any axis will do, however it is rounded.
  bool separates(const Vec3& axis) const {
    Range first, second;
    for (int i = 0; i < 4; ++i)
      for (const auto* at : {&points_.t0, &points_.t1}) (i < first_count_ ? first : second).add(axis, (*at)[i]);
    const double gap = std::max(second.least - first.most, first.least - second.most);
    return gap > kThicknessSlack * thickness_ * axis.norm();
  }

 private:
  const MovingPoints& points_;
  int first_count_;
  double thickness_;
};

double thickness_of(const ContinuousInput& input, const std::array<Index, 4>& vertices, int first_count) {
  const double* const of = input.vertex_thickness;
  if (of == nullptr) return 0;
  double first = 0, second = 0;
  for (int i = 0; i < 4; ++i) {
    double& largest = i < first_count ? first : second;
    largest = std::max(largest, of[vertices[i]]);
  }
  return first + second;
}

}  // namespace

bool stay_apart_by_axis(const ContinuousInput& input, const std::array<Index, 4>& vertices, int first_count) {
  const MovingPoints points = moving_points(input, vertices);
  const AxisTest test(points, first_count, thickness_of(input, vertices, first_count));
  const auto& x = points.t0;
  if (first_count == 1) {
    const Vec3 edges[3] = {x[2] - x[1], x[3] - x[2], x[1] - x[3]}, across = edges[0].cross(edges[1]);
    return test.separates(across) || std::any_of(std::begin(edges), std::end(edges),
                                                 [&](const Vec3& edge) { return test.separates(across.cross(edge)); });
  }
  const Vec3 a = x[1] - x[0], b = x[3] - x[2], between = x[2] - x[0], across = a.cross(b);
  // Of parallel edges any axis across them, the one from one to the other; and one along them.
  return test.separates(across) || test.separates(across.cross(a)) || test.separates(across.cross(b)) ||
         test.separates(a.squaredNorm() * between - a.dot(between) * a) || test.separates(a);
}

bool are_still(const ContinuousInput& input, const std::array<Index, 4>& vertices) {
  return std::all_of(vertices.begin(), vertices.end(),
                     [&](Index v) { return input.positions_t0[v] == input.positions_t1[v]; });
}

}  // namespace selvage
