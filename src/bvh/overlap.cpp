#include "bvh/overlap.h"

#include "bvh/pairs_kernel.h"
#include "bvh/traverse_pairs.h"
#include "core/merge_sorted.h"
#include "core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

template <bool kSelf>
PairWork split_work(const Bvh& a, const Bvh& b, std::size_t wanted, const std::function<bool(NodePair)>& keep) {
  PairWork work;
  if (a.nodes().empty() || b.nodes().empty()) return work;
  const auto visit = [&](Index i, Index j) {
    work.found.push_back(kSelf ? IndexPair(std::min(i, j), std::max(i, j)) : IndexPair(i, j));
  };
  const auto add = [&](std::vector<NodePair>& pieces, NodePair pair) {
    if (!keep || keep(pair)) pieces.push_back(pair);
  };
  add(work.pieces, kRoots);
  while (!work.pieces.empty() && work.pieces.size() < wanted) {
    std::vector<NodePair> smaller;
    for (const NodePair& piece : work.pieces) {
      ++work.compared;
      work.compared_selves += kSelf && piece.a == piece.b;
      traversal::compare_children<kSelf>(
          a.nodes(), b.nodes(), piece, [&](NodePair pair) { add(smaller, pair); },
          [&](const PrimitivePairs& pairs) { traversal::visit_each(a.nodes(), b.nodes(), pairs, visit); });
    }
    work.pieces = std::move(smaller);
  }
  return work;
}

/// Runs `find(piece, sink)` for all pieces in parallel.
template <typename Find>
std::vector<IndexPair> find_pairs(PairWork work, Find&& find) {
  std::vector<std::vector<IndexPair>> lists(work.pieces.size() + 1);
  lists.back() = std::move(work.found);
  const auto take = [](void* receiver, const IndexPair* pairs, std::size_t count) {
    auto& list = *static_cast<std::vector<IndexPair>*>(receiver);
    list.insert(list.end(), pairs, pairs + count);
  };
  parallel_for(static_cast<std::int64_t>(work.pieces.size()), 1, [&](std::int64_t i) {
    find(work.pieces[i], PairSink{take, &lists[i]});
  });
  return merge_sorted(std::span<const std::vector<IndexPair>>(lists), &IndexPair::first, &IndexPair::second);
}

}  // namespace

PairWork split_pair_work(const Bvh& a, const Bvh& b, std::size_t wanted) {
  return split_work<false>(a, b, wanted, {});
}

PairWork split_self_pair_work(const Bvh& bvh, std::size_t wanted, const std::function<bool(NodePair)>& keep) {
  return split_work<true>(bvh, bvh, wanted, keep);
}

std::vector<IndexPair> overlapping_pairs(const Bvh& a, const Bvh& b) {
  return find_pairs(split_pair_work(a, b, kPairPieces), [&](NodePair piece, PairSink sink) {
    SELVAGE_DISPATCH(find_pairs_kernel, a.nodes(), b.nodes(), piece, sink);
  });
}

std::vector<IndexPair> self_overlapping_pairs(const Bvh& bvh) {
  return find_pairs(split_self_pair_work(bvh, kPairPieces), [&](NodePair piece, PairSink sink) {
    SELVAGE_DISPATCH(find_self_pairs_kernel, bvh.nodes(), piece, sink);
  });
}

}  // namespace selvage
