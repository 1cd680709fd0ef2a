#pragma once

#include "self_collision/surface/discrete_input.h"

namespace selvage {

// Finds the pairs of triangles in pieces of a search of a surface against itself, or below pairs of nodes of two
// hierarchies; and those among listed pairs (primitive of a, primitive of b).
#define SELVAGE_DISCRETE_KERNEL                                                                 \
  void find_self_collisions(const DiscreteInput&, std::span<const SelfPiece>, DiscreteResult&); \
  void find_collisions(const DiscreteInput&, std::span<const NodePair>, DiscreteResult&);       \
  void test_listed_pairs(const DiscreteInput&, std::span<const IndexPair>, DiscreteResult&);
namespace baseline {
SELVAGE_DISCRETE_KERNEL
}
namespace avx2 {
SELVAGE_DISCRETE_KERNEL
}
namespace avx512 {
SELVAGE_DISCRETE_KERNEL
}
#undef SELVAGE_DISCRETE_KERNEL

/// Decides a pair of triangles (of a, of b) exactly and records it where it meets and the filters keep it. Compiled
/// once, for every x86-64.
void decide_pair(const DiscreteInput& input, Index first, Index second, DiscreteResult& result);

/// Records those of `count` pairs, all known to cross, that the filters keep.
void take_crossing_pairs(const DiscreteInput& input, const Index* first, const Index* second, int count,
                         DiscreteResult& result);

}  // namespace selvage
