#include "simulation/vbd/vertex_colours.h"

#include "simulation/cloth_pieces.h"

#include <algorithm>
#include <utility>

namespace selvage {

namespace {

/// The elements, triangles and hinges of each vertex.
class VertexGroups {
 public:
  explicit VertexGroups(const Model& model)
      : mesh_(model.mesh),
        triangles_(model.triangles),
        hinges_(list_cloth_hinges(model)),
        of_vertex_(mesh_.vertex_count()) {
    for (std::size_t t = 0; t < triangles_.size(); ++t) add(triangles_[t], t);
    for (std::size_t h = 0; h < hinges_.size(); ++h) add(hinges_[h].vertices, triangles_.size() + h);
  }

  std::size_t count(Index v) const { return mesh_.vertex_elements(v).size() + of_vertex_[v].size(); }

  /// Calls visit with each vertex of each group of v.
  template <typename Visit>
  void visit(Index v, const Visit& visit) const {
    const auto visit_all = [&](const auto& vertices) { std::for_each(vertices.begin(), vertices.end(), visit); };
    for (const Index e : mesh_.vertex_elements(v)) visit_all(mesh_.elements()[e]);
    for (const std::size_t group : of_vertex_[v])
      group < triangles_.size() ? visit_all(triangles_[group]) : visit_all(hinges_[group - triangles_.size()].vertices);
  }

 private:
  void add(std::span<const Index> vertices, std::size_t group) {
    for (const Index v : vertices) of_vertex_[v].push_back(group);
  }

  const TetMesh& mesh_;
  std::span<const VertexTuple<3>> triangles_;
  std::vector<ClothHinge> hinges_;
  std::vector<std::vector<std::size_t>> of_vertex_;
};

}  // namespace

VertexColours colour_vertices(const Model& model) {
  const VertexGroups groups(model);
  const Index vertex_count = model.mesh.vertex_count();
  std::vector<Index> order;
  for (Index v = 0; v < vertex_count; ++v)
    if (groups.count(v) > 0) order.push_back(v);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return groups.count(a) > groups.count(b); });
  std::vector<Index> colour_of(vertex_count, kNone), taken_by;
  for (const Index v : order) {
    groups.visit(v, [&](Index w) {
      if (colour_of[w] != kNone) taken_by[colour_of[w]] = v;
    });
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
  for (Index v = 0; v < vertex_count; ++v)
    if (colour_of[v] != kNone) colours.vertices[next[colour_of[v]]++] = v;
  colours.of_vertex = std::move(colour_of);
  return colours;
}

}  // namespace selvage
