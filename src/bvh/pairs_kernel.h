#pragma once

#include "bvh/overlap.h"
#include "core/isa.h"

namespace selvage {

/// Takes pairs as they are found, some at a time.
struct PairSink {
  void (*take)(void* receiver, const IndexPair* pairs, std::size_t count);
  void* receiver;
};

// Finds the overlapping pairs below a pair of nodes; for a self-overlap b is a.
#define SELVAGE_PAIRS_KERNEL                                                                                     \
  void find_pairs_kernel(std::span<const BvhNode> a, std::span<const BvhNode> b, NodePair start, PairSink sink); \
  void find_self_pairs_kernel(std::span<const BvhNode> nodes, NodePair start, PairSink sink);
namespace baseline {
SELVAGE_PAIRS_KERNEL
}
namespace avx2 {
SELVAGE_PAIRS_KERNEL
}
namespace avx512 {
SELVAGE_PAIRS_KERNEL
}
#undef SELVAGE_PAIRS_KERNEL

}  // namespace selvage
