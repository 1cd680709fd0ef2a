#pragma once

#include "bvh/bvh.h"
#include "selvage/geometry/closest_point.h"
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

/// A point of a surface.
struct SurfacePlace {
  Index triangle = kNone;
  ClosestPoint<3, 3> point;
};

/// The solid inside a closed surface, as a collider.
class MeshCollider {
 public:
  /// Where no two triangles have a vertex in common, those in the same place are taken as one.
  /// @throws Error  when a position is not finite, or the surface is not closed or faces inwards; it names `where`
  MeshCollider(const std::string& where, const MeshShape& shape);

  /// Takes new positions for the same triangles. O(n log n): the hierarchy is built anew, so that what comes back does
  /// not depend on the positions before.
  /// @param positions  (n_vertices)
  void set_positions(std::vector<Vec3> positions);

  /// No way out leads through these triangles, unless all are such.
  /// @param is_buried  (n_triangles) not 0: behind it is another collider
  void set_buried(std::vector<std::uint8_t> is_buried);

  /// The point of the surface that is closest to p. O(log n) near the surface.
  SurfacePlace find_nearest(const Vec3& p) const;
  std::optional<Hit> find_hit(const Vec3& p) const { return find_hit(p, 0); }
  /// The shortest way to a distance from the surface, for what is nearer or inside.
  std::optional<Hit> find_hit(const Vec3& p, double distance) const;
  /// Unit, outward; zero where triangles around a vertex cancel out.
  Vec3 vertex_normal(Index vertex) const { return vertex_normals_[vertex].normalized(); }
  std::span<const BvhNode> nodes() const { return bvh_.nodes(); }
  std::array<Vec3, 3> corners(Index triangle) const {
    const auto& [a, b, c] = mesh_.triangles()[triangle];
    return {positions_[a], positions_[b], positions_[c]};
  }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  const TriangleMesh& mesh() const { return mesh_; }
  std::span<const Vec3> positions() const { return positions_; }

 private:
  template <typename Counts>
  SurfacePlace find_nearest(const Vec3& p, Counts&& counts) const;
  Vec3 normal_at(const SurfacePlace& place) const;

  std::vector<Vec3> positions_;
  TriangleMesh mesh_;
  Bvh bvh_;
  /// Pseudo-normals (Baerentzen and Aanaes 2005): of any length, and on the right side of all faces around.
  std::vector<Vec3> triangle_normals_, edge_normals_, vertex_normals_;
  Eigen::AlignedBox3d bounds_;
  std::vector<std::uint8_t> is_buried_;  ///< (n_triangles); empty: none is
};

}  // namespace selvage
