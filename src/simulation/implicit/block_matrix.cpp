#include "simulation/implicit/block_matrix.h"

#include "core/parallel.h"

#include <algorithm>
#include <map>

namespace selvage {

namespace {

constexpr std::int64_t kPatternGrain = 512;

void sort_once(std::vector<Index>& row) {
  std::sort(row.begin(), row.end());
  row.erase(std::unique(row.begin(), row.end()), row.end());
}

}  // namespace

std::int64_t BlockMatrix::find(Index row, Index column) const {
  return std::lower_bound(columns.begin() + first[row], columns.begin() + first[row + 1], column) - columns.begin();
}

void BlockMatrix::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const {
  y.resize(x.size());
  parallel_for(row_count(), kPatternGrain, [&](std::int64_t row) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::int64_t i = first[row]; i < first[row + 1]; ++i)
      sum.noalias() += blocks[i] * x.segment<3>(3 * Eigen::Index{columns[i]});
    y.segment<3>(3 * row) = sum;
  });
}

BlockMatrix make_pattern(Index vertex_count, std::span<const VertexTuple<4>> elements,
                         std::span<const std::span<const Index>> groups) {
  std::vector<std::vector<Index>> rows(vertex_count);
  const auto join = [&](std::span<const Index> group) {
    for (const Index v : group) rows[v].insert(rows[v].end(), group.begin(), group.end());
  };
  for (const VertexTuple<4>& element : elements) join(element);
  for (const std::span<const Index> group : groups) join(group);
  parallel_for(vertex_count, kPatternGrain, [&](std::int64_t row) {
    rows[row].push_back(static_cast<Index>(row));
    sort_once(rows[row]);
  });
  BlockMatrix pattern;
  pattern.first.push_back(0);
  for (const std::vector<Index>& row : rows) {
    pattern.columns.insert(pattern.columns.end(), row.begin(), row.end());
    pattern.first.push_back(std::ssize(pattern.columns));
  }
  return pattern;
}

void extend_pattern(const BlockMatrix& pattern, std::span<const std::span<const Index>> groups, BlockMatrix& matrix) {
  // Few rows have more: each lists all that it has then.
  std::map<Index, std::vector<Index>> longer;
  for (const std::span<const Index> group : groups)
    for (const Index v : group) longer[v].insert(longer[v].end(), group.begin(), group.end());
  for (auto& [row, columns] : longer) {
    columns.insert(columns.end(), pattern.columns.begin() + pattern.first[row],
                   pattern.columns.begin() + pattern.first[row + 1]);
    sort_once(columns);
  }
  matrix.first = pattern.first;
  std::int64_t more = 0;
  auto next = longer.begin();
  for (Index row = 0; row < pattern.row_count(); ++row) {
    matrix.first[row] += more;
    if (next == longer.end() || next->first != row) continue;
    more += std::ssize(next->second) - (pattern.first[row + 1] - pattern.first[row]);
    ++next;
  }
  matrix.first.back() += more;
  matrix.columns.resize(matrix.first.back());
  matrix.blocks.resize(matrix.first.back());
  parallel_for(pattern.row_count(), kPatternGrain, [&](std::int64_t row) {
    const auto found = longer.find(static_cast<Index>(row));
    const std::span<const Index> columns =
        found != longer.end() ? std::span<const Index>(found->second)
                              : std::span<const Index>(pattern.columns)
                                    .subspan(pattern.first[row], pattern.first[row + 1] - pattern.first[row]);
    std::copy(columns.begin(), columns.end(), matrix.columns.begin() + matrix.first[row]);
  });
}

}  // namespace selvage
