#pragma once

#include "boundary_path/input/leaf_node.h"
#include "boundary_path/input/normal_cones.h"
#include "boundary_path/input/rims.h"

namespace selvage {

/// Positions of vertices from the box origin, to the nearest floats.
struct RoundedPositions {
  const std::array<float, 4>* at;
  float error;  ///< bounds that of each coordinate; no less than the last bit of the extent of all
};

/// The hierarchy over the elements of a pose.
template <int D>
struct ElementTask {
  RoundedPositions positions;
  const LeafNode<D + 1>* leaves;
  BvhNode* nodes;
  std::uint8_t*
      ray_marks;  ///< two per vertex: whether an element holds the forward, the backward ray of a boundary one
  std::uint32_t* inner_rays;  ///< per node, bit 8 k + i: child i holds the forward ray of its vertex k, an inner one
};

struct ElementFindings {
  std::int64_t inner_rays = 0;  ///< number of bits
  Index doubtful = 0;
};

/// The hierarchy over the boundary faces of a pose.
template <int D>
struct FaceTask {
  RoundedPositions positions;
  const LeafNode<D>* leaves;
  BvhNode* nodes;
  const NormalBox* vertex_normals;
  NormalBox* node_normals;
  ConeNode* cones;
};

/// Boundary vertices of a solid, by their rims.
struct RimTask {
  RoundedPositions positions;
  const Index* vertices;  ///< of Rims
  NormalBox* normals;
  std::uint8_t* proven;  ///< per vertex
};

// For the nodes [first, last): sets the boxes of all elements, and looks at their orientations and rays. `doubtful` has
// room for eight entries a node and takes those that single precision cannot tell, or that are not positive; they are
// not counted.
//
// For the nodes [first, last), those below them done: sets the boxes of all faces, and the cones of normals.
//
// For batches of rims: proves that vertices are locally injective. Those that are get their normals' box and a mark;
// the others are listed in `doubtful`, whose number is returned.
#define SELVAGE_DECLARE_POSE_KERNEL(isa)                                                             \
  namespace isa {                                                                                    \
  ElementFindings examine_elements(const ElementTask<2>&, Index first, Index last, Index* doubtful); \
  ElementFindings examine_elements(const ElementTask<3>&, Index first, Index last, Index* doubtful); \
  void fit_faces(const FaceTask<2>&, Index first, Index last);                                       \
  void fit_faces(const FaceTask<3>&, Index first, Index last);                                       \
  Index prove_rims(const RimTask&, std::span<const RimBatch>, Index* doubtful);                      \
  }

SELVAGE_DECLARE_POSE_KERNEL(baseline)
SELVAGE_DECLARE_POSE_KERNEL(avx2)
SELVAGE_DECLARE_POSE_KERNEL(avx512)

#undef SELVAGE_DECLARE_POSE_KERNEL

}  // namespace selvage
