#pragma once

#include "selvage/core/types.h"

#include <array>
#include <cmath>

namespace selvage {

/// A plane curve given by the angle of its tangent over arc length in [0, length]; it begins at the origin.
///
/// The point is the integral of the tangent: from the nearest node of a table, by Gauss quadrature, so that it is
/// smooth to rounding and its derivative is the tangent.
template <typename Angle>
class PlaneCurve {
 public:
  PlaneCurve(double length, Angle angle) : angle_(angle), step_(length / kNodes) {
    nodes_.reserve(kNodes + 1);
    nodes_.emplace_back(0, 0);
    for (int i = 0; i < kNodes; ++i) nodes_.push_back(nodes_.back() + integral(i * step_, (i + 1) * step_));
  }

  Vec2 point(double s) const {
    const int node = std::clamp(static_cast<int>(s / step_), 0, kNodes);
    return nodes_[node] + integral(node * step_, s);
  }
  Vec2 tangent(double s) const { return {std::cos(angle_(s)), std::sin(angle_(s))}; }

 private:
  static constexpr int kNodes = 1024;

  Vec2 integral(double from, double to) const {
    static constexpr std::array<double, 3> kPlace = {0.0, 0.5384693101056831, 0.9061798459386640};
    static constexpr std::array<double, 3> kWeight = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double middle = (from + to) / 2, half = (to - from) / 2;
    Vec2 sum = kWeight[0] * tangent(middle);
    for (int i = 1; i < 3; ++i) {
      sum += kWeight[i] * (tangent(middle - half * kPlace[i]) + tangent(middle + half * kPlace[i]));
    }
    return half * sum;
  }

  Angle angle_;
  double step_;
  std::vector<Vec2> nodes_;
};

}  // namespace selvage
