#include "self_collision/continuous/marked_vertices.h"

#include <algorithm>
#include <utility>

namespace selvage {

MarkedVertices::MarkedVertices(const TriangleMesh& mesh)
    : mesh_(mesh), is_marked_(mesh.vertex_count(), 0), is_triangle_marked_(mesh.triangle_count(), 0) {}

void MarkedVertices::mark(Index vertex) {
  if (std::exchange(is_marked_[vertex], 1) != 0) return;
  vertices_.push_back(vertex);
  for (const Index t : mesh_.vertex_triangles(vertex))
    if (std::exchange(is_triangle_marked_[t], 1) == 0) triangles_.push_back(t);
}

void MarkedVertices::clear() {
  for (const Index v : vertices_) is_marked_[v] = 0;
  for (const Index t : triangles_) is_triangle_marked_[t] = 0;
  vertices_.clear();
  triangles_.clear();
}

bool MarkedVertices::has_any(std::span<const Index> vertices) const {
  return std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return has(v); });
}

std::span<const std::uint8_t> MarkedVertices::node_marks(std::span<const BvhNode> nodes) {
  node_marks_.resize(nodes.size());
  for (std::int64_t n = std::ssize(nodes) - 1; n >= 0; --n) {
    unsigned mask = 0;
    for (int i = 0; i < nodes[n].child_count; ++i) {
      const Index child = nodes[n].children[i];
      mask |= static_cast<unsigned>((child < 0 ? node_marks_[~child] : is_triangle_marked_[child]) != 0) << i;
    }
    node_marks_[n] = static_cast<std::uint8_t>(mask);
  }
  return node_marks_;
}

}  // namespace selvage
