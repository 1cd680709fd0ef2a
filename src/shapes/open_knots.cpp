#include "shapes/open_knots.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace selvage {

namespace {

/// The knot's first half, from one end to the middle: over the strand of the middle, under the other end, around, and
/// over the other end. The second half is the first, turned about y, and run backwards.
const std::array<Vec3, 10> kHalf{{{-9, 0, 0},
                                  {-7, 0, 0},
                                  {-5, 0, 0},
                                  {-3, 0, 0.2},
                                  {-1.3, -0.3, 0.9},
                                  {0, -2, -0.9},
                                  {1.2, -3.7, -0.2},
                                  {2.8, -3.3, 0},
                                  {2.8, -1.6, 0.5},
                                  {1.4, -0.1, 0.9}}};
constexpr double kInnerScale = 0.32;
/// Height of the strand in the middle.
constexpr double kMiddle = 0.4;

Vec3 turned(const Vec3& p) {
  return {-p[0], p[1], -p[2]};
}

/// Control points of a cubic spline, the ends three times so that it begins and ends there.
std::vector<Vec3> with_ends(std::vector<Vec3> points) {
  const Vec3 first = points.front(), last = points.back();
  points.insert(points.begin(), 2, first);
  points.insert(points.end(), 2, last);
  return points;
}

std::vector<Vec3> overhand_controls() {
  std::vector<Vec3> points(kHalf.begin(), kHalf.end());
  points.emplace_back(0, kMiddle, 0);
  for (std::size_t i = kHalf.size(); i-- > 0;) points.push_back(turned(kHalf[i]));
  return with_ends(points);
}

std::vector<Vec3> nested_controls() {
  std::vector<Vec3> points(kHalf.begin(), kHalf.end());
  // The strand in the middle runs towards -x, as the small knot does once it is turned; its long ends are left out.
  std::vector<Vec3> inner(kHalf.begin() + 3, kHalf.end());
  inner.emplace_back(0, kMiddle, 0);
  for (std::size_t i = kHalf.size(); i-- > 3;) inner.push_back(turned(kHalf[i]));
  for (const Vec3& p : inner) points.push_back(Vec3(0, kMiddle, 0) + kInnerScale * turned(p));
  for (std::size_t i = kHalf.size(); i-- > 0;) points.push_back(turned(kHalf[i]));
  return with_ends(points);
}

/// A uniform cubic B-spline.
Vec3 spline_point(const std::vector<Vec3>& controls, double t) {
  const auto pieces = static_cast<double>(controls.size() - 3);
  const double at = std::clamp(t, 0.0, 1.0) * pieces, piece = std::min(std::floor(at), pieces - 1), u = at - piece;
  const auto i = static_cast<std::size_t>(piece);
  const double v = 1 - u;
  return (v * v * v * controls[i] + (3 * u * u * u - 6 * u * u + 4) * controls[i + 1] +
          (3 * v * v * v - 6 * v * v + 4) * controls[i + 2] + u * u * u * controls[i + 3]) /
         6;
}

}  // namespace

Vec3 overhand_point(double t) {
  static const std::vector<Vec3> controls = overhand_controls();
  return spline_point(controls, t);
}

Vec3 nested_overhand_point(double t) {
  static const std::vector<Vec3> controls = nested_controls();
  return spline_point(controls, t);
}

}  // namespace selvage
