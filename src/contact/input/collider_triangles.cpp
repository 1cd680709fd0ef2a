#include "contact/input/collider_triangles.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage {

TriangleMesh surface_with_colliders(const TetMesh& mesh, std::span<const VertexTuple<3>> colliders,
                                    std::size_t position_count, std::span<const VertexTuple<3>> cloth) {
  if (colliders.empty() && cloth.empty()) return boundary_surface(mesh);
  const Index first = mesh.vertex_count(), end = static_cast<Index>(position_count);
  for (std::size_t t = 0; t < colliders.size(); ++t)
    for (const Index v : colliders[t])
      if (v < first || v >= end)
        throw Error(fmt::format("triangle {} of the colliders", t), fmt::format("has the vertex {}", v),
                    fmt::format("colliders have vertices in [{}, {}): after those of the mesh", first, end));
  for (std::size_t t = 0; t < cloth.size(); ++t)
    for (const Index v : cloth[t])
      if (v < 0 || v >= first || !mesh.vertex_elements(v).empty())
        throw Error(fmt::format("triangle {} of the cloth", t), fmt::format("has the vertex {}", v),
                    fmt::format("cloth has vertices in [0, {}) that no element has", first));
  std::vector<VertexTuple<3>> triangles(mesh.boundary_faces().begin(), mesh.boundary_faces().end());
  triangles.insert(triangles.end(), cloth.begin(), cloth.end());
  triangles.insert(triangles.end(), colliders.begin(), colliders.end());
  return {end, std::move(triangles)};
}

SelfCollisionOptions options_with_colliders(Index body_faces, const TriangleMesh& surface) {
  SelfCollisionOptions options;
  if (surface.triangle_count() == body_faces) return options;
  options.filters.groups.assign(surface.triangle_count(), 0);
  std::fill_n(options.filters.groups.begin(), body_faces, kNone);
  return options;
}

}  // namespace selvage
