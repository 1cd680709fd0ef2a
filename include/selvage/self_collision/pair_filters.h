#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Filters of the pairs of a surface, as data. A member that is empty or zero filters nothing and costs nothing.
///
/// Labels belong to triangles. A vertex or an edge counts as every triangle that it lies on: a pair of a vertex and a
/// face, or of two edges, stays when one of its pairs of triangles does.
struct PairFilters {
  /// (n_triangles) triangles of the same group are no pair; kNone: in no group.
  std::vector<Index> groups;

  /// (n_triangles) bits: the layers that a triangle is on, and those that it collides with. A pair stays when each
  /// collides with a layer of the other. Without `seen_layers`, when they have a layer in common.
  std::vector<std::uint32_t> layers;
  std::vector<std::uint32_t> seen_layers;

  /// (n_triangles) not 0: the triangle never moves; two that do not are no pair.
  std::vector<std::uint8_t> is_static;

  /// Pairs of triangles, in any order: no others are pairs unless the list is empty; and none of these is.
  std::vector<IndexPair> allowed_pairs;
  std::vector<IndexPair> forbidden_pairs;

  /// Where a path of this many edges or fewer leads from a vertex of the one to a vertex of the other, there is no
  /// pair.
  int neighbour_rings = 0;

  /// (n_vertices) positions at rest: triangles, or features, nearer than `rest_distance` there are no pair. [m]
  std::vector<Vec3> rest_positions;
  double rest_distance = 0;
};

}  // namespace selvage
