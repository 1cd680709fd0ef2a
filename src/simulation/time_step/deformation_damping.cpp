#include "simulation/time_step/deformation_damping.h"

#include "core/parallel.h"
#include "core/union_find.h"
#include "simulation/rigid_motion.h"

#include <algorithm>

namespace selvage {

namespace {

/// Vertices of a slice. Sums depend on it: their order is that of slices.
constexpr std::size_t kSlice = 4096;

/// Of bodies of elements those connected across faces, then those of cloth: across vertices.
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

DeformationDamping::DeformationDamping(const Model& model) : model_(model) {
  const std::vector<Index> pieces = pieces_of_vertices(model);
  for (Index v = 0; v < model.mesh.vertex_count(); ++v)
    if (pieces[v] != kNone && model.inverse_masses[v] > 0) vertices_.push_back(v);
  std::stable_sort(vertices_.begin(), vertices_.end(), [&](Index a, Index b) { return pieces[a] < pieces[b]; });
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const Index piece = pieces[vertices_[i]];
    if (slices_.empty() || slices_.back().piece != piece || i - slices_.back().first == kSlice)
      slices_.push_back({piece, i, i});
    slices_.back().last = i + 1;
    piece_count_ = std::max(piece_count_, piece + 1);
  }
}

void DeformationDamping::apply(double kept, std::span<const Vec3> positions, std::span<Vec3> velocities) const {
  std::vector<MomentumSums> of_pieces(piece_count_);
  for (const Slice& slice : slices_)
    of_pieces[slice.piece] = MomentumSums(positions[vertices_[slice.first]], velocities[vertices_[slice.first]]);
  std::vector<MomentumSums> sums(slices_.size());
  parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
    sums[s] = of_pieces[slices_[s].piece];
    for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i) {
      const Index v = vertices_[i];
      sums[s].add(1 / model_.inverse_masses[v], positions[v], velocities[v]);
    }
  });
  for (std::size_t s = 0; s < slices_.size(); ++s) of_pieces[slices_[s].piece].add(sums[s]);
  std::vector<RigidMotion> motions;
  for (const MomentumSums& piece : of_pieces) motions.push_back(piece.motion());
  parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
    const RigidMotion& rigid = motions[slices_[s].piece];
    for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i) {
      const Index v = vertices_[i];
      const Vec3 together = rigid(positions[v]);
      velocities[v] = together + kept * (velocities[v] - together);
    }
  });
}

}  // namespace selvage
