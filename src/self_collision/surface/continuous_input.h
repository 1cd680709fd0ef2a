#pragma once

#include "self_collision/surface/culled_nodes.h"
#include "self_collision/surface/leaf_vertices.h"
#include "self_collision/surface/neighbour_pair.h"
#include "selvage/self_collision/continuous_collision.h"

#include <atomic>

namespace selvage {

class PairFilter;

/// The position of a vertex in box units at the start of a step (x, y, z, 0) and at its end (x, y, z, 0), each
/// coordinate rounded to the nearest float.
struct alignas(32) MovingVertex {
  float coordinates[8];
};

/// The corners of a triangle, and the features whose representative triangle it is: bit k for vertex k, bit 3 + k for
/// the edge opposite to it. A pair of features is tested only with the pair of their representative triangles, so each
/// pair at most once (Curtis, Tamstorf, Manocha 2008; EDC section 6.1). Loaded as a row of four.
struct alignas(16) MovingTriangle {
  VertexTuple<3> vertices;
  std::uint32_t represented;
};

/// A vertex and a face, or two edges, and their vertices in this order.
struct FeaturePair {
  Index first, second;
  std::array<Index, 4> vertices;

  bool operator<(const FeaturePair& other) const {
    return first != other.first ? first < other.first : second < other.second;
  }
};

/// Input of a search over a step.
struct ContinuousInput {
  std::span<const BvhNode> nodes;
  const MovingTriangle* triangles;
  const std::array<Index, 3>* triangle_edges;  ///< opposite to the corners of each triangle
  const VertexTuple<2>* edges;
  const Vec3* positions_t0;
  const Vec3* positions_t1;
  const MovingVertex* rounded;     ///< per vertex
  const float* thickness;          ///< per vertex, in box units, rounded up; null: none
  const double* vertex_thickness;  ///< per vertex [m]; null: none
  const PairFilter* filter;        ///< null: keeps all
  CulledNodes culled = {};
  const LeafVertices* leaves = nullptr;            ///< per node; for a search of nonadjacent triangles
  std::span<const NeighbourPair> neighbours = {};  ///< likewise
  /// In box units, rounded up. Where one of them is more than 0, pairs of features are listed, not decided, which come
  /// nearer than the distance if each vertex strays by the margin along every axis.
  float margin = 0, distance = 0;
  const std::uint8_t* strayed = nullptr;  ///< per vertex: pairs without any such vertex are not listed

  bool is_listing() const { return margin > 0 || distance > 0; }
};

/// Result of one piece of a search.
struct ContinuousResult {
  ContinuousPairs pairs;
  ContinuousCounters counters;
  std::vector<FeaturePair> near_vertex_face, near_edge_edge;  ///< where the input is listing
  std::atomic<bool>* stop = nullptr;  ///< set when a pair is found, where one is enough; else null
};

}  // namespace selvage
