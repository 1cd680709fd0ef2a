#include "scene/reading/shown_surface.h"

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

}  // namespace selvage
