#pragma once

#include "bvh/bvh.h"

#include <functional>

namespace selvage {

/// All pairs (primitive of a, primitive of b) whose boxes meet, borders included; sorted. Parallel.
std::vector<IndexPair> overlapping_pairs(const Bvh& a, const Bvh& b);

/// All pairs i < j of primitives of one hierarchy whose boxes meet, borders included; each once, sorted. Parallel.
std::vector<IndexPair> self_overlapping_pairs(const Bvh& bvh);

/// A node of one hierarchy and a node of another, whose primitives remain to be compared; or of a node only the
/// primitives among its children. Within one hierarchy, a node with itself stands for all pairs of primitives in it.
struct NodePair {
  Index a;
  Index b;
  bool primitives_of_a;
  bool primitives_of_b;

  bool operator==(const NodePair&) const = default;
};

/// A search for pairs, cut into independent pieces.
struct PairWork {
  std::vector<NodePair> pieces;
  std::vector<IndexPair> found;      ///< pairs of primitives met while cutting; in no piece
  std::int64_t compared = 0;         ///< pairs of nodes whose children were compared while cutting
  std::int64_t compared_selves = 0;  ///< those of a node with itself
};

/// Pieces enough to keep threads busy where pieces differ in size.
inline constexpr std::size_t kPairPieces = 512;

/// Cuts the search for overlapping pairs into at least `wanted` pieces, where there are as many; for a visit_pairs() or
/// visit_self_pairs() of each piece in parallel. The same pieces in the same order, whatever the number of threads.
PairWork split_pair_work(const Bvh& a, const Bvh& b, std::size_t wanted);

/// @param keep  pairs of nodes that need no comparison are left out with all below them; empty: keeps all
PairWork split_self_pair_work(const Bvh& bvh, std::size_t wanted, const std::function<bool(NodePair)>& keep = {});

}  // namespace selvage
