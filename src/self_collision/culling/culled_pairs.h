#pragma once

#include "core/parallel.h"
#include "self_collision/culling/surface_pieces.h"
#include "self_collision/surface/culled_nodes.h"

#include <cstdint>
#include <vector>

namespace selvage {

/// Statistics of culling.
struct CullingCounters {
  std::int64_t tested_nodes = 0;      ///< nodes that a method tested
  std::int64_t culled_nodes = 0;      ///< nodes that need no comparison with themselves
  std::int64_t culled_triangles = 0;  ///< triangles in them

  template <typename SearchCounters>
  void add_to(SearchCounters& counters) const {
    counters.tested_nodes += tested_nodes;
    counters.culled_nodes += culled_nodes;
    counters.culled_triangles += culled_triangles;
  }
};

/// The comparisons within one hierarchy that a method leaves out: nodes of its bounding volume test tree (BVTT).
struct CulledPairs {
  /// (n_nodes) not 0: the BVTT node (N, N) is culled. Not set below such a node. Empty: none is.
  std::vector<std::uint8_t> self;

  /// (n_nodes) bit i of node N: the BVTT node of N and its sibling number i is culled. Empty: none is.
  std::vector<std::uint8_t> siblings;

  CullingCounters counters;

  /// As kernels read it.
  CulledNodes nodes() const {
    return {self.empty() ? nullptr : self.data(), siblings.empty() ? nullptr : siblings.data()};
  }
};

/// Tests the nodes of a hierarchy from the root down, those below a node only where the node itself is not culled.
/// Parallel within a level; the same for any number of threads.
///
/// @tparam Workspace     memory of one thread
/// @param min_triangles  nodes with fewer triangles are not tested
/// @param can_cull       `bool can_cull(Index node, Workspace&)`, thread-safe for different nodes
template <typename Workspace, typename CanCull>
void cull_from_root(const Bvh& bvh, const SurfacePieces& pieces, Index min_triangles, CulledPairs& culled,
                    CanCull&& can_cull) {
  const auto nodes = bvh.nodes();
  culled.self.assign(nodes.size(), 0);
  std::vector<Index> level = {0}, below;
  while (!level.empty()) {
    parallel_ranges(std::ssize(level), 64, [&](std::int64_t first, std::int64_t last) {
      Workspace workspace;
      for (std::int64_t i = first; i < last; ++i)
        if (can_cull(level[i], workspace)) culled.self[level[i]] = 1;
    });
    below.clear();
    for (const Index n : level) {
      ++culled.counters.tested_nodes;
      if (culled.self[n] != 0) {
        ++culled.counters.culled_nodes;
        culled.counters.culled_triangles += pieces.ranges()[n].size();
        continue;
      }
      for (int i = 0; i < nodes[n].child_count && nodes[n].children[i] < 0; ++i) {
        const Index child = ~nodes[n].children[i];
        if (pieces.ranges()[child].size() >= min_triangles) below.push_back(child);
      }
    }
    std::swap(level, below);
  }
}

/// For cull_from_root(): a test that needs no memory.
struct NoWorkspace {};

}  // namespace selvage
