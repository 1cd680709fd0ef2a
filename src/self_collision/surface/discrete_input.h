#pragma once

#include "self_collision/surface/culled_nodes.h"
#include "self_collision/surface/leaf_vertices.h"
#include "self_collision/surface/neighbour_pair.h"
#include "selvage/self_collision/self_collision.h"

#include <atomic>

namespace selvage {

class PairFilter;

/// One of the two surfaces that a search compares.
struct SurfaceView {
  std::span<const BvhNode> nodes;
  const LeafVertices* leaves;  ///< per node
  const Index* triangle_of;    ///< per primitive of the hierarchy its triangle; null: the same
  const VertexTuple<3>* triangles;
  const Vec3* positions;
  const std::array<float, 4>* rounded;  ///< per vertex: its place in box units, see DeformedSurface
  const float* thickness;               ///< per triangle, in box units; null: none
  const double* vertex_thickness;       ///< per vertex [m]; null: none
};

/// Input of a search: a surface against itself, against a part of itself (a), or against another surface.
struct DiscreteInput {
  SurfaceView a, b;
  bool one_surface;  ///< equal numbers of vertices mean the same vertex
  bool include_adjacent;
  const std::uint8_t* in_subset;  ///< per triangle of b whether it is in a; null: a is no part of b
  const PairFilter* filter;       ///< null: keeps all
  CulledNodes culled = {};
  std::span<const NeighbourPair> neighbours = {};  ///< of a search of a surface against itself
};

/// Result of one piece of a search.
struct DiscreteResult {
  std::vector<TrianglePair> pairs;
  SelfCollisionCounters counters;
  std::atomic<bool>* stop = nullptr;  ///< set when a pair is found, where one is enough; else null
};

}  // namespace selvage
