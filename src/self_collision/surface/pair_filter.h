#pragma once

#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/pair_filters.h"

#include <optional>

namespace selvage {

/// Filters made ready for one surface.
class PairFilter {
 public:
  /// @throws Error  when a list does not fit the mesh
  PairFilter(const TriangleMesh& mesh, const PairFilters& filters);

  /// Nothing where the filters keep all.
  static std::optional<PairFilter> where_needed(const TriangleMesh& mesh, const PairFilters& filters);

  bool keeps_triangles(Index a, Index b) const;
  bool keeps_vertex_face(Index vertex, Index face) const;
  bool keeps_edges(Index a, Index b) const;

 private:
  bool labels_keep(Index a, Index b) const;
  bool labels_keep_any(std::span<const Index> a, std::span<const Index> b) const;
  bool are_neighbours(std::span<const Index> a, std::span<const Index> b) const;
  std::array<Vec3, 3> at_rest(Index triangle) const;

  const TriangleMesh& mesh_;
  PairFilters filters_;
};

}  // namespace selvage
