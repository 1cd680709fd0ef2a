#pragma once

#include "bvh/bvh.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/simulation/collider.h"

#include <Eigen/Geometry>

#include <optional>

namespace selvage {

/// The shortest way out of a collider.
struct Hit {
  Vec3 normal;   ///< unit, outward
  double depth;  ///< [m]
};

/// The solid inside a closed surface, as a collider.
class MeshCollider {
 public:
  /// Where no two triangles have a vertex in common, those in the same place are taken as one.
  /// @throws Error  when a position is not finite, or the surface is not closed or faces inwards; it names `where`
  MeshCollider(const std::string& where, const MeshShape& shape);

  std::optional<Hit> find_hit(const Vec3& p) const;
  std::span<const BvhNode> nodes() const { return bvh_.nodes(); }
  std::array<Vec3, 3> corners(Index triangle) const {
    const auto& [a, b, c] = mesh_.triangles()[triangle];
    return {positions_[a], positions_[b], positions_[c]};
  }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  const TriangleMesh& mesh() const { return mesh_; }
  std::span<const Vec3> positions() const { return positions_; }

 private:
  std::vector<Vec3> positions_;
  TriangleMesh mesh_;
  Bvh bvh_;
  /// Pseudo-normals (Baerentzen and Aanaes 2005): of any length, and on the right side of all faces around.
  std::vector<Vec3> triangle_normals_, edge_normals_, vertex_normals_;
  Eigen::AlignedBox3d bounds_;
};

}  // namespace selvage
