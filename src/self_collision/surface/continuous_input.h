#pragma once

#include "self_collision/surface/culled_nodes.h"
#include "self_collision/surface/leaf_vertices.h"
#include "self_collision/surface/neighbour_pair.h"
#include "selvage/self_collision/continuous_collision.h"

#include <atomic>

namespace selvage {

class PairFilter;

/// Where a vertex is in the frame at the start of a step (x, y, z, 0) and at its end (x, y, z, 0), each coordinate
/// rounded to the nearest float.
struct alignas(32) MovingRow {
  float coordinates[8];
};

/// The corners of a triangle that is looked at, and which of its features are its own to answer for: bit k for vertex
/// k, bit 3 + k for the edge opposite to it. Loaded as a row of four.
struct alignas(16) MovingTriangle {
  VertexTuple<3> vertices;
  std::uint32_t owned;
};

/// What a search over a step reads.
struct ContinuousInput {
  std::span<const BvhNode> nodes;
  const MovingTriangle* triangles;
  const std::array<Index, 3>* triangle_edges;  ///< opposite to the corners of each triangle
  const VertexTuple<2>* edges;
  const Vec3* positions_t0;
  const Vec3* positions_t1;
  const MovingRow* rounded;        ///< per vertex
  const float* thickness;          ///< per vertex, in the frame, rounded up; null: none
  const double* vertex_thickness;  ///< per vertex [m]; null: none
  const PairFilter* filter;        ///< null: keeps all
  CulledNodes spared = {};
  const LeafVertices* leaves = nullptr;            ///< per node; for a search of strangers alone
  std::span<const NeighbourPair> neighbours = {};  ///< likewise
};

/// What one piece of a search brings.
struct ContinuousResult {
  ContinuousPairs pairs;
  ContinuousCounters counters;
  std::atomic<bool>* stop = nullptr;  ///< set by whoever finds a pair, where one is enough; else null
};

}  // namespace selvage
