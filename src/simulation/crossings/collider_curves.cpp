#include "simulation/crossings/collider_curves.h"

#include "simulation/colliders/prepared_collider.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace selvage {

namespace {

using std::numbers::pi;

/// A body with straight edges sinks into a round shape of radius r by at most h^2 / 8r, h the length of its edges: with
/// four spacings an edge, 1/50 of h at this radius.
constexpr double kMaxRoundness = 25;
/// Triangles of the polygon that stands for an end of a cylinder.
constexpr int kEndTriangles = 32;

ColliderCurve ring(const Vec3& centre, const Vec3& axis, double radius) {
  const auto [u, v] = across(axis);
  return {centre, radius * u, radius * v, 0, 2 * pi, true};
}

ColliderFeatures features_of(const PlaneShape&, double) {
  return {};
}

ColliderFeatures features_of(const BoxContainer&, double) {
  return {};
}

ColliderFeatures features_of(const Bowl& bowl, double) {
  return {{}, {ring(bowl.centre, bowl.axis.normalized(), bowl.radius)}, {}};
}

ColliderFeatures features_of(const SphereShape& sphere, double spacing) {
  ColliderFeatures features;
  if (sphere.radius > kMaxRoundness * spacing) return features;
  const auto rings = static_cast<int>(std::ceil(pi * sphere.radius / spacing));
  for (int i = 0; i <= rings; ++i) {
    const double angle = pi * i / rings, height = sphere.radius * std::cos(angle);
    const Vec3 centre = sphere.centre + height * Vec3::UnitZ();
    if (i == 0 || i == rings)
      features.points.push_back(centre);
    else
      features.curves.push_back(ring(centre, Vec3::UnitZ(), sphere.radius * std::sin(angle)));
  }
  return features;
}

ColliderFeatures features_of(const CylinderShape& cylinder, double spacing) {
  const Vec3 axis = cylinder.axis.normalized(), half = cylinder.length / 2 * axis;
  ColliderFeatures features;
  for (const double side : {-1.0, 1.0}) {
    const ColliderCurve rim = ring(cylinder.centre + side * half, axis, cylinder.radius);
    features.curves.push_back(rim);
    for (int i = 0; i < kEndTriangles; ++i)
      features.faces.push_back(
          {rim.middle, rim.point(2 * pi * i / kEndTriangles), rim.point(2 * pi * (i + 1) / kEndTriangles)});
  }
  if (cylinder.radius > kMaxRoundness * spacing) return features;
  const ColliderCurve rim = features.curves[0];
  const int lines = std::max(4, static_cast<int>(std::ceil(2 * pi * cylinder.radius / spacing)));
  for (int i = 0; i < lines; ++i)
    features.curves.push_back({rim.point(2 * pi * i / lines), 2 * half, Vec3::Zero(), 0, 1, false});
  for (const double side : {-1.0, 1.0}) features.points.push_back(cylinder.centre + side * half);
  return features;
}

/// The third vertex of a triangle beside one of its edges.
struct EdgeSide {
  Vec3 tip, normal;
};

/// Ends of an edge, the lesser first: equal places are one vertex.
using EdgeEnds = std::array<std::array<double, 3>, 2>;

/// Edges at which the surface is convex, by their places: as in STL, triangles may have no vertex in common.
std::vector<EdgeEnds> convex_edges(const MeshShape& shape) {
  const auto place = [&](Index v) {
    const Vec3& p = shape.positions[static_cast<std::size_t>(v)];
    return std::array{p[0], p[1], p[2]};
  };
  std::map<EdgeEnds, std::vector<EdgeSide>> sides;
  for (const auto& t : shape.triangles) {
    const auto at = [&](int i) -> const Vec3& { return shape.positions[static_cast<std::size_t>(t[i % 3])]; };
    const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0)).normalized();
    for (int i = 0; i < 3; ++i) {
      EdgeEnds ends{place(t[i]), place(t[(i + 1) % 3])};
      if (ends[1] < ends[0]) std::swap(ends[0], ends[1]);
      sides[ends].push_back({at(i + 2), normal});
    }
  }
  std::vector<EdgeEnds> edges;
  for (const auto& [ends, two] : sides) {
    const Vec3 end(ends[0].data()), tip = two.back().tip - end;
    if (two.size() != 2 || two.front().normal.dot(tip) < -1e-6 * tip.norm()) edges.push_back(ends);
  }
  return edges;
}

ColliderFeatures features_of(const MeshShape& shape, double) {
  ColliderFeatures features;
  std::vector<std::array<double, 3>> corners;
  for (const EdgeEnds& ends : convex_edges(shape)) {
    const Vec3 a(ends[0].data()), b(ends[1].data());
    features.curves.push_back({a, b - a, Vec3::Zero(), 0, 1, false});
    corners.insert(corners.end(), ends.begin(), ends.end());
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  for (const auto& corner : corners) features.points.emplace_back(corner.data());
  const auto at = [&](Index v) -> const Vec3& { return shape.positions[static_cast<std::size_t>(v)]; };
  for (const auto& [a, b, c] : shape.triangles) features.faces.push_back({at(a), at(b), at(c)});
  return features;
}

ColliderFeatures features_of(const KeyframedShape& shape, double spacing) {
  return features_of(MeshShape{shape.positions.front(), shape.triangles}, spacing);
}

}  // namespace

ColliderFeatures find_features(const Collider& collider, double spacing) {
  return std::visit([&](const auto& shape) { return features_of(shape, spacing); }, collider.shape);
}

}  // namespace selvage
