#include "cli/reports/quality.h"

#include "core/parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace selvage::cli {

namespace {

struct ElementQuality {
  double smallest_angle = 0, largest_angle = 0;  // [rad]
  double ratio = 0, measure = 0;
};

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Divides edges by the power of two that brings the longest near 1, so that no product of a few of them overflows or
/// vanishes.
/// @return  the exponent
int take_scale(std::array<Vec3, 3>& edges) {
  double largest = 0;
  for (const Vec3& edge : edges) largest = std::max(largest, edge.cwiseAbs().maxCoeff());
  if (!(largest > 0) || !std::isfinite(largest)) return 0;
  const int exponent = std::ilogb(largest);
  for (Vec3& edge : edges)
    for (double& x : edge) x = std::ldexp(x, -exponent);
  return exponent;
}

ElementQuality quality_of(std::span<const Vec3> x, const VertexTuple<3>& t) {
  std::array<Vec3, 3> sides{x[t[2]] - x[t[1]], x[t[0]] - x[t[2]], x[t[1]] - x[t[0]]};
  const int exponent = take_scale(sides);
  const double area = sides[0].cross(sides[1]).norm() / 2;
  if (!(area > 0)) return {};
  ElementQuality q{std::numbers::pi, 0, 0, std::ldexp(area, 2 * exponent)};
  for (int i = 0; i < 3; ++i) {
    const double angle = angle_between(-sides[(i + 1) % 3], sides[(i + 2) % 3]);
    q.smallest_angle = std::min(q.smallest_angle, angle);
    q.largest_angle = std::max(q.largest_angle, angle);
  }
  const double a = sides[0].norm(), b = sides[1].norm(), c = sides[2].norm();
  const double inradius = 2 * area / (a + b + c), circumradius = a * b * c / (4 * area);
  q.ratio = 2 * inradius / circumradius;
  return q;
}

ElementQuality quality_of(std::span<const Vec3> x, const VertexTuple<4>& t) {
  std::array<Vec3, 3> edges{x[t[1]] - x[t[0]], x[t[2]] - x[t[0]], x[t[3]] - x[t[0]]};
  const int exponent = take_scale(edges);
  const auto& [a, b, c] = edges;
  const double six_volumes = a.dot(b.cross(c));
  if (six_volumes == 0) return {};
  // Outward normals, as long as twice the faces' areas; all flip together when the element is inverted.
  const std::array<Vec3, 4> normals{(b - a).cross(c - a), c.cross(b), a.cross(c), b.cross(a)};
  ElementQuality q{std::numbers::pi, 0, 0, std::ldexp(six_volumes / 6, 3 * exponent)};
  double surface = 0;
  for (int i = 0; i < 4; ++i) {
    surface += normals[i].norm() / 2;
    for (int j = i + 1; j < 4; ++j) {
      const double dihedral = std::numbers::pi - angle_between(normals[i], normals[j]);
      q.smallest_angle = std::min(q.smallest_angle, dihedral);
      q.largest_angle = std::max(q.largest_angle, dihedral);
    }
  }
  const Vec3 to_centre = a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  const double circumradius = to_centre.norm() / (2 * std::abs(six_volumes));
  q.ratio = 3 * (std::abs(six_volumes) / (2 * surface)) / circumradius;
  return q;
}

/// Sums over blocks of fixed size, one after the other: the same bits for any number of threads.
template <int N>
Quality measure(std::span<const Vec3> positions, std::span<const VertexTuple<N>> elements) {
  constexpr std::int64_t kBlock = 8192;
  const auto count = static_cast<std::int64_t>(elements.size());
  std::vector<Quality> blocks((count + kBlock - 1) / kBlock);
  parallel_for(static_cast<std::int64_t>(blocks.size()), 1, [&](std::int64_t block) {
    Quality sum{.smallest_angle = std::numbers::pi, .worst_ratio = 1};
    for (std::int64_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      const ElementQuality q = quality_of(positions, elements[i]);
      sum.smallest_angle = std::min(sum.smallest_angle, q.smallest_angle);
      sum.largest_angle = std::max(sum.largest_angle, q.largest_angle);
      sum.worst_ratio = std::min(sum.worst_ratio, q.ratio);
      sum.mean_smallest_angle += q.smallest_angle;
      sum.mean_ratio += q.ratio;
      sum.measure += q.measure;
    }
    blocks[block] = sum;
  });
  Quality all{.smallest_angle = std::numbers::pi, .worst_ratio = 1};
  for (const Quality& block : blocks) {
    all.smallest_angle = std::min(all.smallest_angle, block.smallest_angle);
    all.largest_angle = std::max(all.largest_angle, block.largest_angle);
    all.worst_ratio = std::min(all.worst_ratio, block.worst_ratio);
    all.mean_smallest_angle += block.mean_smallest_angle / static_cast<double>(count);
    all.mean_ratio += block.mean_ratio / static_cast<double>(count);
    all.measure += block.measure;
  }
  for (double* angle : {&all.smallest_angle, &all.mean_smallest_angle, &all.largest_angle}) {
    *angle *= 180 / std::numbers::pi;
  }
  return all;
}

}  // namespace

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexTuple<4>> tetrahedra) {
  return measure<4>(positions, tetrahedra);
}

Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexTuple<3>> triangles) {
  return measure<3>(positions, triangles);
}

}  // namespace selvage::cli
