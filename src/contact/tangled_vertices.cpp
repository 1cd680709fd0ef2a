#include "contact/tangled_vertices.h"

#include <algorithm>
#include <utility>

namespace selvage {

TangledVertices::TangledVertices(const TriangleMesh& surface, Index first_cloth, Index body_faces, bool is_strict)
    : surface_(surface),
      body_faces_(body_faces),
      is_strict_(is_strict),
      is_tangled_(surface.vertex_count(), 0),
      is_cloth_(surface.vertex_count(), 0) {
  for (Index t = first_cloth; t < body_faces; ++t)
    for (const Index v : surface.triangles()[t]) is_cloth_[v] = 1;
}

bool TangledVertices::has_any(std::span<const Index> vertices) const {
  return std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return has(v); });
}

void TangledVertices::add(std::span<const Index> vertices) {
  for (const Index v : vertices)
    if (std::exchange(is_tangled_[v], 1) == 0) vertices_.push_back(v);
}

void TangledVertices::mark(std::span<const Index> inside_vertices, std::span<const Index> inside_edges,
                           std::span<const TrianglePair> crossings) {
  for (const Index v : vertices_) is_tangled_[v] = 0;
  vertices_.clear();
  if (is_strict_ && crossings.empty()) {
    if (!inside_vertices.empty()) add_enclosed_pieces(inside_vertices);
    return;
  }
  add(inside_vertices);
  for (const Index e : inside_edges) add(surface_.edges()[e]);
  // The triangles of a collider may be large: a crossing says nothing of all that their corners belong to.
  for (const TrianglePair& pair : crossings) {
    add(surface_.triangles()[pair.first]);
    if (pair.second < body_faces_) add(surface_.triangles()[pair.second]);
  }
}

/// A piece of the surface that meets nothing is inside something with all of its vertices, or with none.
void TangledVertices::add_enclosed_pieces(std::span<const Index> inside_vertices) {
  std::vector<std::uint8_t> is_inside(is_tangled_.size(), 0), is_reached(is_tangled_.size(), 0);
  for (const Index v : inside_vertices) is_inside[v] = 1;
  std::vector<Index> piece;
  for (const Index start : inside_vertices) {
    if (std::exchange(is_reached[start], 1) != 0) continue;
    piece.assign(1, start);
    for (std::size_t i = 0; i < piece.size(); ++i)
      for (const Index t : surface_.vertex_triangles(piece[i]))
        for (const Index v : surface_.triangles()[t])
          if (std::exchange(is_reached[v], 1) == 0) piece.push_back(v);
    if (std::all_of(piece.begin(), piece.end(), [&](Index v) { return is_inside[v] != 0; })) add(piece);
  }
}

}  // namespace selvage
