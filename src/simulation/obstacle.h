#pragma once

#include "selvage/bvh/bvh.h"
#include "selvage/contact/friction.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/simulation/collider.h"

#include <optional>

namespace selvage {

/// How a point gets out of a solid the shortest way.
struct Hit {
  Vec3 normal;   ///< unit, outward
  double depth;  ///< [m]
};

/// The solid inside a closed surface.
class MeshSolid {
 public:
  /// @throws Error  when a position is not finite or the surface is not closed; it names `where`
  MeshSolid(const std::string& where, const MeshShape& shape);

  std::optional<Hit> find_hit(const Vec3& p) const;

 private:
  std::vector<Vec3> positions_;
  TriangleMesh mesh_;
  Bvh bvh_;
  /// Pseudo-normals (Baerentzen and Aanaes 2005): of any length, and on the right side of all faces around.
  std::vector<Vec3> triangle_normals_, edge_normals_, vertex_normals_;
  Vec3 lower_, upper_;
};

/// A collider made ready. A container of six walls is six obstacles.
struct Obstacle {
  std::variant<PlaneShape, Bowl, SphereShape, CylinderShape, MeshSolid> solid;
  Motion motion;
  Friction friction;

  /// Where the point is inside, in the collider's own coordinates: where it is at rest.
  std::optional<Hit> find_hit(const Vec3& p) const;
};

/// @throws Error  when a shape, a motion or a friction is impossible; it names which
std::vector<Obstacle> make_obstacles(std::span<const Collider> colliders);

/// @throws Error  when a motion is impossible
void check_motion(const std::string& where, const Motion& motion);

}  // namespace selvage
