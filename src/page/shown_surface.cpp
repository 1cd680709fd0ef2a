#include "page/shown_surface.h"

#include "page/encoding.h"

namespace selvage {

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

void add_surface(Page& page, const ShownSurface& surface) {
  page.head()["vertices"] = surface.vertices.size();
  page.head()["vertices_of_mesh"] = surface.place.size();
  page.head()["triangles"] = surface.triangles.size();
  std::vector<Index> corners;
  corners.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  page.add_block("triangles", pack_integers(corners, 3));
  page.add_block("vertices", pack_integers(surface.vertices, 1));
}

}  // namespace selvage
