#include "picture/surface_corners.h"

#include "core/parallel.h"

#include <Eigen/Geometry>

namespace selvage {

namespace {

constexpr double kSmoothCosine = 0.65;  // faces that differ by less than about 50 degrees share a normal

/// Triangles around each vertex.
struct Fans {
  std::vector<Index> first, triangles;

  Fans(Index vertex_count, std::span<const VertexTuple<3>> all)
      : first(vertex_count + 1, 0), triangles(3 * all.size()) {
    for (const auto& t : all) {
      for (const Index v : t) ++first[v + 1];
    }
    for (Index v = 0; v < vertex_count; ++v) first[v + 1] += first[v];
    std::vector<Index> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < all.size(); ++t) {
      for (const Index v : all[t]) triangles[next[v]++] = static_cast<Index>(t);
    }
  }

  std::span<const Index> around(Index v) const {
    return std::span(triangles).subspan(first[v], first[v + 1] - first[v]);
  }
};

}  // namespace

std::vector<ScreenVertex> place_corners(std::span<const Vec3> positions, std::span<const VertexTuple<3>> triangles,
                                        const Camera& camera, std::span<const double> vertex_value) {
  const Fans fans(static_cast<Index>(positions.size()), triangles);
  std::vector<Vec3> normals(triangles.size());  // as long as twice the area
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    normals[t] = (positions[b] - positions[a]).cross(positions[c] - positions[a]);
  }
  std::vector<ScreenVertex> corners(3 * triangles.size());
  parallel_for(static_cast<std::int64_t>(triangles.size()), 1024, [&](std::int64_t t) {
    for (int i = 0; i < 3; ++i) {
      const Index v = triangles[t][i];
      Vec3 normal = Vec3::Zero();
      for (const Index other : fans.around(v)) {
        const double cosine = normals[t].dot(normals[other]);
        if (cosine >= kSmoothCosine * normals[t].norm() * normals[other].norm()) normal += normals[other];
      }
      if (normal.norm() > 0) normal.normalize();
      const Vec3 place = camera.project(positions[v]);
      corners[3 * t + i] = {static_cast<float>(place[0]),
                            static_cast<float>(place[1]),
                            static_cast<float>(place[2]),
                            camera.rotate(normal).cast<float>(),
                            static_cast<float>(std::max(vertex_value[v], 0.0)),
                            vertex_value[v] < 0 ? 0.f : 1.f};
    }
  });
  return corners;
}

}  // namespace selvage
