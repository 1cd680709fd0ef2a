#include "simulation/implicit/block_matrix.h"

#include "core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr std::int64_t kRowGrain = 512;

/// The vertices of all groups of each vertex, with repetitions.
std::vector<std::vector<Index>> neighbours_of(Index vertex_count, std::span<const std::span<const Index>> groups) {
  std::vector<std::vector<Index>> neighbours(vertex_count);
  for (const std::span<const Index> group : groups)
    for (const Index v : group) neighbours[v].insert(neighbours[v].end(), group.begin(), group.end());
  return neighbours;
}

}  // namespace

std::int64_t BlockMatrix::find(Index row, Index column) const {
  return std::lower_bound(columns.begin() + first[row], columns.begin() + first[row + 1], column) - columns.begin();
}

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  y.resize(x.size());
  parallel_for(row_count(), kRowGrain, [&](std::int64_t row) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::int64_t i = first[row]; i < first[row + 1]; ++i)
      sum.noalias() += blocks[i] * x.segment<3>(3 * Eigen::Index{columns[i]});
    y.segment<3>(3 * row) = sum;
  });
}

BlockMatrix make_block_matrix(Index vertex_count, std::span<const VertexTuple<4>> elements,
                              std::span<const std::span<const Index>> groups) {
  std::vector<std::vector<Index>> rows = neighbours_of(vertex_count, groups);
  for (const VertexTuple<4>& element : elements)
    for (const Index v : element) rows[v].insert(rows[v].end(), element.begin(), element.end());
  parallel_for(vertex_count, kRowGrain, [&](std::int64_t row) {
    rows[row].push_back(static_cast<Index>(row));
    std::sort(rows[row].begin(), rows[row].end());
    rows[row].erase(std::unique(rows[row].begin(), rows[row].end()), rows[row].end());
  });
  BlockMatrix matrix;
  matrix.first.push_back(0);
  for (const std::vector<Index>& row : rows) matrix.first.push_back(matrix.first.back() + std::ssize(row));
  matrix.columns.resize(matrix.first.back());
  matrix.blocks.resize(matrix.first.back());
  parallel_for(vertex_count, kRowGrain, [&](std::int64_t row) {
    std::copy(rows[row].begin(), rows[row].end(), matrix.columns.begin() + matrix.first[row]);
    for (std::int64_t i = matrix.first[row]; i < matrix.first[row + 1]; ++i) matrix.blocks[i].setZero();
  });
  return matrix;
}

}  // namespace selvage
