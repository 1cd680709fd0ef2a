#include "simulation/vbd/vertex_colours.h"

#include <algorithm>
#include <utility>

namespace selvage {

VertexColours colour_vertices(const TetMesh& mesh) {
  std::vector<Index> order;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.vertex_elements(v).empty()) order.push_back(v);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return mesh.vertex_elements(a).size() > mesh.vertex_elements(b).size(); });
  std::vector<Index> colour_of(mesh.vertex_count(), kNone), taken_by;
  for (const Index v : order) {
    for (const Index e : mesh.vertex_elements(v))
      for (const Index w : mesh.elements()[e])
        if (colour_of[w] != kNone) taken_by[colour_of[w]] = v;
    const auto free = std::find_if(taken_by.begin(), taken_by.end(), [&](Index by) { return by != v; });
    colour_of[v] = static_cast<Index>(free - taken_by.begin());
    if (free == taken_by.end()) taken_by.push_back(kNone);
  }
  VertexColours colours;
  colours.first.assign(taken_by.size() + 1, 0);
  for (const Index v : order) ++colours.first[colour_of[v] + 1];
  for (std::size_t c = 0; c < taken_by.size(); ++c) colours.first[c + 1] += colours.first[c];
  colours.vertices.resize(order.size());
  std::vector<Index> next(colours.first.begin(), colours.first.end() - 1);
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (colour_of[v] != kNone) colours.vertices[next[colour_of[v]]++] = v;
  colours.of_vertex = std::move(colour_of);
  return colours;
}

}  // namespace selvage
