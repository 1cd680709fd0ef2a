#pragma once

#include "selvage/mesh/simplex_mesh.h"
#include "simulation/elements/element_kernel.h"

namespace selvage {

/// Pairs of vertices that share elements, each pair once, and the blocks that elements have of it.
struct ElementEdges {
  std::vector<std::int64_t> first;        ///< (n_vertices + 1) edges to later vertices
  std::vector<Index> ends;                ///< the later vertex of each; ascending for a vertex
  std::vector<std::int64_t> first_items;  ///< (n_edges + 1)
  std::vector<std::int64_t> items;        ///< 2 (6 element + block), and 1 more where the block is the other way round

  std::int64_t edge_count() const { return static_cast<std::int64_t>(ends.size()); }
  /// Sum of an edge's blocks: derivatives by the earlier vertex in rows, by the later in columns.
  Eigen::Matrix3d sum(std::span<const ElementDerivatives> derivatives, std::int64_t edge) const {
    Eigen::Matrix3d there = Eigen::Matrix3d::Zero(), back = there;
    for (std::int64_t i = first_items[edge]; i < first_items[edge + 1]; ++i) {
      const std::int64_t block = items[i] / 2;
      const Eigen::Map<const Eigen::Matrix3d> own(derivatives[block / 6].blocks[block % 6]);
      (items[i] % 2 == 0 ? there : back) += own;
    }
    return there + back.transpose();
  }
};

/// O(n_elements log n_elements).
ElementEdges list_element_edges(const TetMesh& mesh);

}  // namespace selvage
