#pragma once

#include "boundary_path/input/leaf_node.h"
#include "boundary_path/input/normal_cones.h"
#include "boundary_path/input/path_topology.h"
#include "bvh/box.h"
#include "bvh/bvh.h"
#include "selvage/boundary_path/boundary_path.h"

namespace selvage {

/// Rules that hold for a component in a pose (SPB sections 3.2, 3.5 and 3.6). Its defects matter only to paths that are
/// long enough to meet them: nearer to p than any of them everything holds as in an immersed component.
enum class ComponentState : std::uint8_t {
  kImmersed,   ///< locally injective inside: theorems 1 and 2 hold, and with them culling and bounds from blocked rays
  kOverwound,  ///< no inverted element, but overwound ridges, or folds: only the definition holds
  kInverted,   ///< inverted or flat elements: the rules of section 3.5
};

/// A place where the theorems fail: an inverted or flat element, an overwound ridge, a face with two positive elements
/// on one side.
struct Defect {
  Box box;
  Index component;
};

/// The origin of the single-precision boxes of the hierarchies: the middle of the mesh, for floats are finest near 0.
template <int D>
struct BoxOrigin {
  Vec<D> position = Vec<D>::Zero();

  /// Smallest box of floats around the box between two corners.
  SELVAGE_INLINE Box around(const Vec<D>& lower, const Vec<D>& upper) const {
    Vec<D> low, high;
    for (int i = 0; i < D; ++i) {
      low[i] = lower[i] - position[i];
      high[i] = upper[i] - position[i];
    }
    return enclosing_box<D>(low, high);
  }
  SELVAGE_INLINE Box around_point(const Vec<D>& p) const { return around(p, p); }
};

/// Everything that a search reads: topology, the pose and the hierarchies. Positions are scaled by a power of two so
/// that no product of a few of them overflows.
template <int D>
struct PathInput {
  const Vec<D>* positions;
  const PathElement<D>* elements;
  const VertexTuple<D>* boundary_faces;
  const HalfFace* boundary_owners;
  const std::array<Index, D>* boundary_neighbours;
  const SimplexMesh<D>* mesh;  ///< for the stars of vertices
  std::span<const BvhNode> face_nodes;
  const ConeNode* face_cones;      ///< per node of face_nodes
  const LeafNode<D>* face_leaves;  ///< the same
  const FaceStar<D>* face_stars;
  const std::array<float, 4>* rounded;  ///< positions from the box origin: see DeformedMesh::rounded_positions()
  float rounding;                       ///< bounds the error of each rounded coordinate
  BoxOrigin<D> box_origin;
  const Index* component_of;              ///< per element
  const ComponentState* component_state;  ///< per component
  const std::uint8_t* cullable;           ///< per vertex: its surroundings are proven to be locally injective
  const std::uint8_t* is_split;           ///< per vertex: several corners of the material meet there
  const Index* hints;                     ///< per element: a boundary face that is near in the mesh
  const std::uint8_t* inverted_owner;     ///< per boundary face: its owner is inverted or flat
  std::span<const BvhNode> defect_nodes;  ///< hierarchy over `defects`
  const Defect* defects;
  bool is_oriented;  ///< PathTopology::disagreeing is empty
  PathOptions options;
};

/// A query with positions scaled as the input's, and the face to try first.
template <int D>
struct PathTask {
  PathQuery<D> query;
  Index warm_start = kNone;
};

/// Result of a search, in the input's scale. `face` is kNone when nothing was found.
template <int D>
struct PathResult {
  PathStatus status = PathStatus::kNoPath;
  Index face = kNone;                   ///< the face on which the candidate was found
  int target_count = 0;                 ///< 1: a vertex, 2: an edge, 3: a triangle
  VertexTuple<D> target_vertices{};     ///< ascending where it is no face
  std::array<double, D> barycentric{};  ///< with respect to target_vertices
  Vec<D> offset = Vec<D>::Zero();       ///< s - p
  bool has_normal = false;              ///< whether the next is the face_normal() of a triangle
  Vec<D> normal = Vec<D>::Zero();
};

/// Tasks that help each other, and room for what is found: one result a task and, unless the pointer is null, one set
/// of counters a task.
template <int D>
struct PathBatch {
  std::span<const PathTask<D>> tasks;
  PathResult<D>* results;
  PathCounters* counters;
};

/// Where a kernel gets its work from.
template <int D>
class PathBatches {
 public:
  /// The next batch, once the one before has its results; one without tasks after the last.
  virtual PathBatch<D> next() = 0;

 protected:
  ~PathBatches() = default;
};

}  // namespace selvage
