#pragma once

#include "selvage/bvh/overlap.h"
#include "selvage/self_collision/continuous_collision.h"

#include <atomic>

namespace selvage {

class PairFilter;

/// A box over the whole step, in the frame: rounded outward, a fourth lane of zeros.
struct alignas(32) SweptBox {
  float lower[4];
  float upper[4];
};

/// The corners of a triangle that is looked at, the edges opposite to them, and which of both are its own to answer
/// for.
struct MovingTriangle {
  VertexTuple<3> vertices;
  std::array<Index, 3> edges;
  std::uint32_t owned_vertices, owned_edges;  ///< bits
};

/// What a search over a step reads.
struct ContinuousScene {
  std::span<const BvhNode> nodes;
  const MovingTriangle* triangles;
  const VertexTuple<2>* edges;
  const Vec3* positions_t0;
  const Vec3* positions_t1;
  const std::array<float, 4>* rounded_t0;  ///< per vertex: its place in the frame, each coordinate rounded down
  const std::array<float, 4>* rounded_t1;
  const SweptBox* vertex_boxes;
  const SweptBox* triangle_boxes;
  const PairFilter* filter;  ///< null: keeps all
};

/// What one piece of a search brings.
struct ContinuousResult {
  ContinuousPairs pairs;
  ContinuousCounters counters;
  std::atomic<bool>* stop = nullptr;  ///< set by whoever finds a pair, where one is enough; else null
};

}  // namespace selvage
