#pragma once

#include "bvh/overlap.h"

namespace selvage {

/// Primitives that a nearest search named to its visitor, in order.
struct NearestVisits {
  std::vector<Index> primitives;
  std::vector<float> bounds;  ///< the lower bound of the squared distance that came with each
  std::int64_t nodes = 0;
};

// The traversals as the compiler makes them for one instruction set.
#define SELVAGE_TEST_QUERIES                                                                                     \
  NearestVisits list_within(const Bvh& bvh, const Box& point, float squared_bound);                              \
  NearestVisits find_nearest(const Bvh& bvh, std::span<const Box> boxes, const Box& point, float squared_bound); \
  std::vector<Index> list_overlaps(const Bvh& bvh, const Box& query);                                            \
  std::int64_t count_overlaps_up_to(const Bvh& bvh, const Box& query, std::int64_t most);                        \
  std::vector<IndexPair> list_pairs(const Bvh& a, const Bvh& b);                                                 \
  std::vector<IndexPair> list_self_pairs(const Bvh& bvh);                                                        \
  std::vector<IndexPair> list_self_pairs_of_pieces(const Bvh& bvh, std::span<const NodePair> pieces);            \
  bool check_simd();
namespace baseline {
SELVAGE_TEST_QUERIES
}
namespace avx2 {
SELVAGE_TEST_QUERIES
}
namespace avx512 {
SELVAGE_TEST_QUERIES
}
namespace scalar {
SELVAGE_TEST_QUERIES
}
#undef SELVAGE_TEST_QUERIES

}  // namespace selvage
