#pragma once

#include "self_collision/culling/direction_cone.h"
#include "self_collision/culling/surface_pieces.h"

namespace selvage {

/// Surface normal cones (SNC) and binormal cones (BNC) of the pieces of surface below nodes, refitted from the leaves
/// up (EDC sections 3.3, 4.1 and 5.2.3). A binormal is the cross product of a triangle's normal and one of its edges:
/// it lies in the triangle's plane, to the left of the edge. Over a step all cones hold the directions that occur at
/// any time.
///
/// @tparam kSteps  1: one pose; 2: the two ends of a step
template <int kSteps>
class SurfaceCones {
 public:
  using Poses = std::array<std::span<const Vec3>, kSteps>;

  /// O(n), parallel within each level.
  SurfaceCones(const Bvh& bvh, const SurfacePieces& pieces, const Poses& poses);

  /// The SNC of a node.
  const DirectionCone& normals(Index node) const { return normals_[node]; }
  /// The BNC of a node's edges on the border of the whole surface.
  const DirectionCone& border_binormals(Index node) const { return border_binormals_[node]; }

  /// Normals of the triangle at a place.
  DirectionCone triangle_normals(Index place) const;
  /// Binormals of a directed edge.
  DirectionCone binormals(Index edge) const;

 private:
  std::array<Vec3, 2 * kSteps - 1> area_coefficients(Index place) const;
  void fit(const BvhNode& node, Index n);

  const SurfacePieces* pieces_;
  Poses poses_;
  std::vector<DirectionCone> normals_;
  std::vector<DirectionCone> border_binormals_;
};

}  // namespace selvage
