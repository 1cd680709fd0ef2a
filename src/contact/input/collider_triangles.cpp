#include "contact/input/collider_triangles.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

TriangleMesh surface_with_colliders(const TetMesh& mesh, std::span<const VertexTuple<3>> colliders,
                                    std::size_t position_count) {
  if (colliders.empty()) return boundary_surface(mesh);
  const Index first = mesh.vertex_count(), end = static_cast<Index>(position_count);
  for (std::size_t t = 0; t < colliders.size(); ++t)
    for (const Index v : colliders[t])
      if (v < first || v >= end)
        throw Error(fmt::format("triangle {} of the colliders", t), fmt::format("has the vertex {}", v),
                    fmt::format("colliders have vertices in [{}, {}): after those of the mesh", first, end));
  std::vector<VertexTuple<3>> triangles(mesh.boundary_faces().begin(), mesh.boundary_faces().end());
  triangles.insert(triangles.end(), colliders.begin(), colliders.end());
  return {end, std::move(triangles)};
}

SelfCollisionOptions options_with_colliders(const TetMesh& mesh, const TriangleMesh& surface) {
  SelfCollisionOptions options;
  const auto bodies = static_cast<Index>(mesh.boundary_faces().size());
  if (surface.triangle_count() == bodies) return options;
  options.filters.groups.assign(surface.triangle_count(), 0);
  std::fill_n(options.filters.groups.begin(), bodies, kNone);
  return options;
}

}  // namespace selvage
