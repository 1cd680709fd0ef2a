#include "selvage/bvh/overlap.h"

#include "bvh/pairs_kernel.h"
#include "selvage/bvh/traverse_pairs.h"
#include "selvage/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace selvage {

namespace {

constexpr std::size_t kPieces = 1024;  ///< enough that threads stay busy where pieces differ in size

template <bool kSelf>
PairWork split_work(const Bvh& a, const Bvh& b, std::size_t wanted) {
  PairWork work;
  if (a.nodes().empty() || b.nodes().empty()) return work;
  const auto visit = [&](Index i, Index j) {
    work.found.push_back(kSelf ? IndexPair(std::min(i, j), std::max(i, j)) : IndexPair(i, j));
  };
  work.pieces = {{0, 0}};
  while (!work.pieces.empty() && work.pieces.size() < wanted) {
    std::vector<NodePair> smaller;
    for (const NodePair& piece : work.pieces)
      traversal::compare_children<kSelf>(
          a.nodes(), b.nodes(), piece, [&](NodePair pair) { smaller.push_back(pair); }, visit);
    work.pieces = std::move(smaller);
  }
  return work;
}

/// Sorts lists of distinct pairs (i, j), 0 <= i < first_count, into one: all with the same i are brought together, then
/// sorted by j.
std::vector<IndexPair> merge_sorted(const std::vector<std::vector<IndexPair>>& lists, Index first_count) {
  const auto list_count = static_cast<std::int64_t>(lists.size());
  std::vector<std::int64_t> place(static_cast<std::size_t>(first_count) + 1, 0);
  parallel_for(list_count, 1, [&](std::int64_t l) {
    for (const IndexPair& pair : lists[l])
      std::atomic_ref(place[pair.first + 1]).fetch_add(1, std::memory_order_relaxed);
  });
  std::partial_sum(place.begin(), place.end(), place.begin());
  std::vector<IndexPair> pairs(place.back());
  // Afterwards place[i] is the end of the pairs of i, whatever order threads came in.
  parallel_for(list_count, 1, [&](std::int64_t l) {
    for (const IndexPair& pair : lists[l])
      pairs[std::atomic_ref(place[pair.first]).fetch_add(1, std::memory_order_relaxed)] = pair;
  });
  parallel_for(first_count, 1024, [&](std::int64_t i) {
    std::sort(pairs.begin() + (i == 0 ? 0 : place[i - 1]), pairs.begin() + place[i]);
  });
  return pairs;
}

/// Runs `find(piece, sink)` for all pieces in parallel.
template <typename Find>
std::vector<IndexPair> find_pairs(PairWork work, Index first_count, Find&& find) {
  std::vector<std::vector<IndexPair>> lists(work.pieces.size() + 1);
  lists.back() = std::move(work.found);
  const auto take = [](void* receiver, const IndexPair* pairs, std::size_t count) {
    auto& list = *static_cast<std::vector<IndexPair>*>(receiver);
    list.insert(list.end(), pairs, pairs + count);
  };
  parallel_for(static_cast<std::int64_t>(work.pieces.size()), 1, [&](std::int64_t i) {
    find(work.pieces[i], PairSink{take, &lists[i]});
  });
  return merge_sorted(lists, first_count);
}

}  // namespace

PairWork split_pair_work(const Bvh& a, const Bvh& b, std::size_t wanted) {
  return split_work<false>(a, b, wanted);
}

PairWork split_self_pair_work(const Bvh& bvh, std::size_t wanted) {
  return split_work<true>(bvh, bvh, wanted);
}

std::vector<IndexPair> overlapping_pairs(const Bvh& a, const Bvh& b) {
  return find_pairs(split_pair_work(a, b, kPieces), a.primitive_count(), [&](NodePair piece, PairSink sink) {
    SELVAGE_DISPATCH(find_pairs_kernel, a.nodes(), b.nodes(), piece, sink);
  });
}

std::vector<IndexPair> self_overlapping_pairs(const Bvh& bvh) {
  return find_pairs(split_self_pair_work(bvh, kPieces), bvh.primitive_count(), [&](NodePair piece, PairSink sink) {
    SELVAGE_DISPATCH(find_self_pairs_kernel, bvh.nodes(), piece, sink);
  });
}

}  // namespace selvage
