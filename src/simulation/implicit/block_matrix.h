#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// A square sparse matrix of 3 x 3 blocks, row by row, with all of a symmetric matrix. Products are parallel and the
/// same bits for any number of threads.
struct BlockMatrix {
  std::vector<std::int64_t> first;      ///< (n + 1) the blocks of each row
  std::vector<Index> columns;           ///< of each block; ascending in a row
  std::vector<Eigen::Matrix3d> blocks;  ///< aligned to 16 bytes at least

  Index row_count() const { return static_cast<Index>(first.size()) - 1; }
  /// The block of a row and a column, which must be there.
  std::int64_t find(Index row, Index column) const;
  /// y = this x.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;
};

/// The pattern of a matrix with a block for each pair of vertices of one group, and on the diagonal: without blocks.
///
/// @param groups  vertices that act on one another: an element, a contact; each vertex once a group
BlockMatrix make_pattern(Index vertex_count, std::span<const VertexTuple<4>> elements,
                         std::span<const std::span<const Index>> groups);

/// Gives a matrix a pattern with those of more groups; what its blocks hold means nothing then.
void extend_pattern(const BlockMatrix& pattern, std::span<const std::span<const Index>> groups, BlockMatrix& matrix);

}  // namespace selvage
