#pragma once

#include "self_collision/culling/planar_embedding.h"
#include "self_collision/surface/culled_nodes.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// What culling did.
struct CullingCounters {
  std::int64_t tested_nodes = 0;       ///< nodes asked whether they need a test against themselves
  std::int64_t cleared_nodes = 0;      ///< those that need none
  std::int64_t cleared_triangles = 0;  ///< in them

  template <typename SearchCounters>
  void add_to(SearchCounters& counters) const {
    counters.tested_nodes += tested_nodes;
    counters.cleared_nodes += cleared_nodes;
    counters.cleared_triangles += cleared_triangles;
  }
};

/// Which comparisons within one hierarchy a method leaves out.
struct CulledPairs {
  /// (n_nodes) not 0: the node need not be compared with itself. Not set below such a node. Empty: none.
  std::vector<std::uint8_t> cleared;

  /// (n_nodes) siblings, by their number, with which a node need not be compared. Empty: none.
  std::vector<std::uint8_t> siblings;

  CullingCounters counters;

  /// As kernels read it.
  CulledNodes nodes() const {
    return {cleared.empty() ? nullptr : cleared.data(), siblings.empty() ? nullptr : siblings.data()};
  }
};

/// Finds what a method leaves out of the search of a surface against itself, in one pose or over a step. O(n),
/// parallel; the same for any number of threads. The methods are those of docs/self_collision_cones.md; nothing for
/// kBvh.
///
/// @param test     memory to use again for every pose
/// @param rounded  a step as seen in a frame (see PlanarEmbeddingTest)
/// @param knows_neighbours  whether most triangles are known not to meet their neighbours without that
template <int kSteps>
CulledPairs cull_self_pairs(const SelfCollisionOptions& options, const Bvh& bvh, SurfacePieces& pieces,
                            const typename PlanarEmbeddingTest<kSteps>::Poses& poses, PlanarEmbeddingTest<kSteps>& test,
                            std::span<const MovingRow> rounded = {}, bool knows_neighbours = false);

}  // namespace selvage
