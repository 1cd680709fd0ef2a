#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/simulation/crossings.h"
#include "selvage/simulation/model.h"

namespace selvage {

/// Measures how far bodies stand in one another and in themselves, in any pose and whatever led to it.
///
/// Triangles and vertices are decided exactly. Edges are looked at where they can enter an element: those of a triangle
/// that crosses another, and those with a vertex inside; each at kEdgePoints points between its ends, so that the
/// deepest is exact up to a step between two of them.
class BodyCrossingFinder {
 public:
  static constexpr int kEdgePoints = 7;

  /// @param model  must outlive the finder
  BodyCrossingFinder(const Model& model, std::span<const Vec3> positions);

  /// @param finder  of the model's mesh, in the same pose
  BodyCrossings measure(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions);

  const TriangleMesh& surface() const { return *surface_; }
  SelfCollisionFinder& surface_finder() { return surface_finder_; }
  /// All that meet in the pose measured last, those that only touch too.
  std::span<const TrianglePair> pairs() const { return pairs_; }

 private:
  class Sums;
  void append_cloth_vertices(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions,
                             std::vector<PathQuery<3>>& queries) const;
  void add_vertices(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions, Sums& sums);
  void add_edges(const BoundaryPathFinder<3>& finder, std::span<const Vec3> positions, Sums& sums) const;
  Index body_of(Index vertex) const { return bodies_[static_cast<std::size_t>(vertex)]; }

  const Model* model_;
  std::unique_ptr<TriangleMesh> surface_;  ///< where it is stays the same when this is moved
  SelfCollisionFinder surface_finder_;     ///< refitted from pose to pose
  std::vector<TrianglePair> pairs_;
  std::vector<Index> bodies_;        ///< of the vertices
  std::vector<std::uint8_t> edges_;  ///< of the surface: 1 where one may be inside an element
};

}  // namespace selvage
