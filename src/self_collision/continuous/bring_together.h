#pragma once

#include "core/merge_sorted.h"
#include "self_collision/surface/continuous_input.h"

namespace selvage {

/// The pairs of all pieces of a search, in order.
/// @param counters  to which those of the pieces are added; or null
inline ContinuousPairs bring_together(std::span<ContinuousResult> results, ContinuousCounters* counters) {
  std::vector<std::vector<VertexFacePair>> vertex_face;
  std::vector<std::vector<EdgeEdgePair>> edge_edge;
  for (ContinuousResult& result : results) {
    vertex_face.push_back(std::move(result.pairs.vertex_face));
    edge_edge.push_back(std::move(result.pairs.edge_edge));
    if (counters != nullptr) *counters += result.counters;
  }
  ContinuousPairs pairs{
      merge_sorted(std::span<const std::vector<VertexFacePair>>(vertex_face), &VertexFacePair::vertex,
                   &VertexFacePair::face),
      merge_sorted(std::span<const std::vector<EdgeEdgePair>>(edge_edge), &EdgeEdgePair::first, &EdgeEdgePair::second)};
  return pairs;
}

}  // namespace selvage
