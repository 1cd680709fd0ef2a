#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Up to eight boundary vertices with rims of the same length.
struct RimBatch {
  static constexpr int kWidth = 8;
  std::int64_t first;  ///< Rims::vertices[first + 8 k + i]: vertex i itself (k = 0), the k-th of its rim (k > 0)
  int length;
  int count;  ///< the other lanes repeat the first
};

/// The neighbours of boundary vertices of a solid, in the order of the boundary: counter-clockwise as seen from
/// outside.
struct Rims {
  static constexpr int kMaxLength = 16;
  std::vector<RimBatch> batches;
  std::vector<Index> vertices;
  std::vector<Index> others;  ///< boundary vertices with a longer rim, or more than one

  explicit Rims(const SimplexMesh<3>& mesh);
  /// In the plane there are none: all vertices are among the others.
  explicit Rims(const SimplexMesh<2>& mesh);
};

}  // namespace selvage
