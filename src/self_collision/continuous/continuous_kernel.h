#pragma once

#include "core/isa.h"
#include "self_collision/surface/continuous_input.h"

namespace selvage {

// Finds the pairs of features that meet: of all triangles below a pair of nodes; of nonadjacent triangles (without a
// common vertex) in pieces of a list of neighbours; of listed pairs of triangles; of listed pairs of features, which
// are vertices and faces first.
#define SELVAGE_CONTINUOUS_KERNEL                                                                          \
  void find_continuous_collisions(const ContinuousInput&, NodePair start, ContinuousResult&);              \
  void find_nonadjacent_collisions(const ContinuousInput&, std::span<const SelfPiece>, ContinuousResult&); \
  void test_listed_pairs(const ContinuousInput&, std::span<const IndexPair>, ContinuousResult&);           \
  void test_listed_features(const ContinuousInput&, std::span<const FeaturePair> vertex_face,              \
                            std::span<const FeaturePair> edge_edge, ContinuousResult&);
namespace baseline {
SELVAGE_CONTINUOUS_KERNEL
}
namespace avx2 {
SELVAGE_CONTINUOUS_KERNEL
}
namespace avx512 {
SELVAGE_CONTINUOUS_KERNEL
}
#undef SELVAGE_CONTINUOUS_KERNEL

/// Decide a pair exactly, unless it is known to meet, and record it where it meets and the filters keep it. Compiled
/// once, for every x86-64.
void decide_vertex_face(const ContinuousInput& input, Index vertex, Index face, bool do_meet, ContinuousResult& result);
void decide_edge_edge(const ContinuousInput& input, Index first, Index second, bool do_meet, ContinuousResult& result);

/// Lists a pair as near; `first_count` 1: a vertex and a face, 2: two edges.
void append_near(ContinuousResult& result, int first_count, const FeaturePair& pair);

}  // namespace selvage
