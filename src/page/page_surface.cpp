#include "page/page_surface.h"

#include "page/encoding.h"

namespace selvage {

void add_surface(Page& page, const ShownSurface& surface) {
  page.head()["vertices"] = surface.vertices.size();
  page.head()["vertices_of_mesh"] = surface.place.size();
  page.head()["triangles"] = surface.triangles.size();
  page.add_block("triangles", pack_triangles(surface));
  page.add_block("vertices", pack_integers(surface.vertices, 1));
}

std::string pack_triangles(const ShownSurface& surface) {
  std::vector<Index> corners;
  corners.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return pack_integers(corners, 3);
}

}  // namespace selvage
