#pragma once

#include "self_collision/culling/direction_cone.h"
#include "self_collision/culling/surface_pieces.h"

namespace selvage {

/// Cones around normals and binormals of the pieces below nodes, refitted from the leaves up. A binormal is the cross
/// product of a triangle's normal and one of its edges: within the triangle, to the left of the edge. Over a step all
/// cones hold the directions that occur at any time.
///
/// @tparam kSteps  1: one pose; 2: the two ends of a step
template <int kSteps>
class SurfaceCones {
 public:
  using Poses = std::array<std::span<const Vec3>, kSteps>;

  /// O(n), parallel within each level.
  SurfaceCones(const Bvh& bvh, const SurfacePieces& pieces, const Poses& poses);

  /// (n_nodes) normals.
  const DirectionCone& normals(Index node) const { return normals_[node]; }
  /// (n_nodes) binormals of the edges on the border of the whole surface.
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

/// FASTCD's test: normals within a half space, binormals within a half plane as seen along the axis of the normals.
bool passes_dual_cone_test(const DirectionCone& normals, const DirectionCone& binormals);

}  // namespace selvage
