#include "scene/reading/shown_surface.h"

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

std::vector<VertexTuple<3>> surface_triangles(const IndexedMesh& mesh) {
  if (mesh.tetrahedra.empty()) return mesh.triangles;
  const TetMesh solid(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  return {solid.boundary_faces().begin(), solid.boundary_faces().end()};
}

ShownSurface::ShownSurface(std::size_t vertex_count, std::span<const VertexTuple<3>> surface)
    : place(vertex_count, kNone), triangles(surface.begin(), surface.end()) {
  for (const auto& triangle : surface)
    for (const Index v : triangle) place[static_cast<std::size_t>(v)] = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    if (place[v] == kNone) continue;
    place[v] = static_cast<Index>(vertices.size());
    vertices.push_back(static_cast<Index>(v));
  }
  for (auto& triangle : triangles)
    for (Index& v : triangle) v = place[static_cast<std::size_t>(v)];
}

}  // namespace selvage
