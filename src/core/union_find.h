#pragma once

#include "selvage/core/types.h"

#include <algorithm>
#include <numeric>

namespace selvage {

/// Sets of the numbers from 0 on that are joined two by two. Each set is named by its lowest number, so that names do
/// not depend on the order in which sets are joined.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0); }

  /// The lowest number of a number's set.
  Index lowest(Index i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }

  void join(Index a, Index b) {
    const auto [low, high] = std::minmax({lowest(a), lowest(b)});
    parents_[high] = low;
  }

  /// (count) the set of each number: sets are numbered from 0, in the order of their lowest numbers.
  std::vector<Index> numbered() const {
    std::vector<Index> sets(parents_.size());
    Index count = 0;
    for (Index i = 0; i < std::ssize(sets); ++i) sets[i] = parents_[i] == i ? count++ : sets[parents_[i]];
    return sets;
  }

 private:
  std::vector<Index> parents_;  ///< each number's parent is itself or a lower one
};

}  // namespace selvage
