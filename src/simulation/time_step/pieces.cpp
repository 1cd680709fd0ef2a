#include "simulation/time_step/pieces.h"

#include "core/union_find.h"

#include <algorithm>

namespace selvage {

namespace {

/// Vertices of a slice. Sums depend on it: their order is that of slices.
constexpr std::size_t kSlice = 4096;

std::vector<Index> pieces_of_vertices(const Model& model) {
  std::vector<Index> pieces(model.mesh.vertex_count(), kNone);
  const std::vector<Index> of_elements = model.mesh.element_components();
  Index count = 0;
  for (std::size_t e = 0; e < of_elements.size(); ++e) {
    count = std::max(count, of_elements[e] + 1);
    for (const Index v : model.mesh.elements()[e]) pieces[v] = of_elements[e];
  }
  if (model.triangles.empty()) return pieces;
  UnionFind cloth(pieces.size());
  for (const auto& [a, b, c] : model.triangles) {
    cloth.join(a, b);
    cloth.join(a, c);
  }
  for (const auto& triangle : model.triangles)
    for (const Index v : triangle) {
      Index& of_lowest = pieces[cloth.lowest(v)];
      if (of_lowest == kNone) of_lowest = count++;
      pieces[v] = of_lowest;
    }
  return pieces;
}

}  // namespace

Pieces::Pieces(const Model& model) : of_vertex_(pieces_of_vertices(model)) {
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    count_ = std::max(count_, of_vertex_[v] + 1);
    if (of_vertex_[v] != kNone && model.inverse_masses[v] > 0) vertices_.push_back(v);
  }
  std::stable_sort(vertices_.begin(), vertices_.end(), [&](Index a, Index b) { return of_vertex_[a] < of_vertex_[b]; });
  for (const Index v : vertices_) masses_.push_back(1 / model.inverse_masses[v]);
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Index piece = of_vertex_[vertices_[i]];
    if (slices_.empty() || slices_.back().piece != piece || i - slices_.back().first == kSlice)
      slices_.push_back({piece, i, i});
    slices_.back().last = i + 1;
  }
  first_vertices_.resize(count_, kNone);
  for (const Slice& slice : slices_)
    if (first_vertices_[slice.piece] == kNone) first_vertices_[slice.piece] = vertices_[slice.first];
}

}  // namespace selvage
