#pragma once

#include "bvh/overlap.h"

namespace selvage {

/// A pair of nodes of one hierarchy with a vertex in common, or a node with itself, in a list in which each stands
/// before those of its children: from the place after it to `end`.
struct NeighbourPair {
  NodePair pair;
  Index end;
  /// Children with a vertex in common, which need no comparison: primitives that are neighbours, and pairs of nodes
  /// that stand in the list. Rows and columns as of PrimitivePairs; kUnlisted: what is below is not listed.
  std::uint64_t neighbours;

  static constexpr std::uint64_t kUnlisted = ~std::uint64_t{0};
};

/// A part of a search of a surface against itself.
struct SelfPiece {
  NodePair pair;
  bool may_share;  ///< triangles below may have vertices in common
  /// Where it stands in the list of neighbours, and the end of those below; first == last: nowhere.
  Index first = 0;
  Index last = 0;

  bool is_listed() const { return first < last; }
};

}  // namespace selvage
