#pragma once

#include "bvh/bvh.h"
#include "contact/ways_out/path_contact.h"

namespace selvage {

/// ClosestPointRule::kRestPose: the shortest path in the rest pose, from where the point is in the material; the
/// boundary point that it leads to is taken to where it is now.
class RestPoseRule {
 public:
  RestPoseRule(const TetMesh& mesh, std::span<const Vec3> rest_positions);

  /// One answer per query; kNoPath where the element is flat now.
  std::vector<BoundaryPath<3>> find(std::span<const PathQuery<3>> queries, std::span<const Vec3> positions) const;

 private:
  const TetMesh& mesh_;
  std::vector<Vec3> rest_positions_;
  BoundaryPathFinder<3> finder_;
};

/// ClosestPointRule::kEuclidean: the closest point of the boundary of an object, whatever lies between.
class EuclideanRule {
 public:
  /// @param vertex_objects  (n_vertices) number of each vertex's object; empty: connected components
  EuclideanRule(const TetMesh& mesh, std::span<const Index> vertex_objects);

  /// Takes a new pose. O(n), parallel.
  void place(std::span<const Vec3> positions);

  /// Whether the point of one object, or of a collider, is in an element of another.
  bool applies_to(const PenetratingPoint& point) const;

  /// The closest point of the object that the query's element belongs to.
  BoundaryPath<3> find(const PathQuery<3>& query, std::span<const Vec3> positions) const;

 private:
  Index object_of(Index element) const { return vertex_objects_[mesh_.elements()[element][0]]; }

  const TetMesh& mesh_;
  std::vector<Index> vertex_objects_;
  Bvh faces_;
};

}  // namespace selvage
