#pragma once

#include "selvage/contact/friction.h"
#include "selvage/simulation/collider.h"
#include "simulation/colliders/mesh_collider.h"
#include "simulation/colliders/surface_motion.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace selvage {

/// A cylinder of which an end may stand on another collider, so that no way out leads there.
struct PreparedCylinder : CylinderShape {
  std::array<std::uint8_t, 2> is_end_buried{};  ///< that against its axis, then the other
};

/// A collider as solvers use it. A BoxContainer becomes six planes, a KeyframedShape its surface at the end of a step.
struct PreparedCollider {
  std::variant<PlaneShape, Bowl, SphereShape, PreparedCylinder, MeshCollider> shape;
  Motion motion;
  Friction friction;
  std::unique_ptr<SurfaceMotion> surface_motion{};  ///< of a KeyframedShape; none of any other

  /// Begins a step: a key-framed surface comes to where it is at its ends. Before the first it is where it is at time
  /// 0.
  void set_step(double start_time, double end_time) {
    if (surface_motion) surface_motion->set_step(start_time, end_time, std::get<MeshCollider>(shape));
  }
  /// Whether it moves in the step that set_step() began.
  bool moves(double start_time, double end_time) const {
    return motion.differs(start_time, end_time) || (surface_motion && !surface_motion->is_still());
  }
  bool is_fixed() const { return motion.keyframes.empty() && !surface_motion; }
  /// Where a point comes to that moves with the shape in the step, both in the collider's own coordinates.
  Vec3 carry(const Vec3& p) const {
    return surface_motion ? surface_motion->carry(p, std::get<MeshCollider>(shape)) : p;
  }
};

/// Two unit vectors across an axis: with it they are right-handed.
inline std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 u = axis.unitOrthogonal();
  return {u, axis.cross(u)};
}

/// The shortest way out of a shape in the collider's own coordinates; nothing for a point outside. Inline, since it is
/// called for every vertex, of which few are inside.
inline std::optional<Hit> find_hit(const PlaneShape& plane, const Vec3& p) {
  const double height = plane.normal.dot(p - plane.point);
  if (height >= 0) return {};
  return Hit{plane.normal, -height};
}

inline std::optional<Hit> find_hit(const Bowl& bowl, const Vec3& p) {
  const Vec3 offset = p - bowl.centre;
  const double height = bowl.axis.dot(offset), distance = offset.norm();
  if (height >= 0 || distance <= bowl.radius) return {};
  if (-height < distance - bowl.radius) return Hit{bowl.axis, -height};
  return Hit{-offset / distance, distance - bowl.radius};
}

inline std::optional<Hit> find_hit(const SphereShape& sphere, const Vec3& p) {
  const Vec3 offset = p - sphere.centre;
  const double distance = offset.norm();
  if (distance >= sphere.radius) return {};
  return Hit{distance > 0 ? Vec3(offset / distance) : Vec3(Vec3::UnitZ()), sphere.radius - distance};
}

inline std::optional<Hit> find_hit(const PreparedCylinder& cylinder, const Vec3& p) {
  const Vec3 offset = p - cylinder.centre;
  const double along = cylinder.axis.dot(offset);
  const Vec3 across = offset - along * cylinder.axis;
  const double distance = across.norm(), side = cylinder.radius - distance;
  if (std::abs(along) >= cylinder.length / 2 || side <= 0) return {};
  const auto& [is_first_buried, is_second_buried] = cylinder.is_end_buried;
  const bool leads_back = is_second_buried != 0 || (is_first_buried == 0 && along < 0);
  const double end = cylinder.length / 2 + (leads_back ? along : -along);
  if ((end < side && !(is_first_buried != 0 && is_second_buried != 0)) || distance == 0)
    return Hit{leads_back ? Vec3(-cylinder.axis) : cylinder.axis, end};
  return Hit{across / distance, side};
}

inline std::optional<Hit> find_hit(const MeshCollider& mesh, const Vec3& p) {
  return mesh.find_hit(p);
}

/// What is nearer to a mesh than a distance, and the solid.
struct GrownMesh {
  const MeshCollider& mesh;
  double by;
};

inline std::optional<Hit> find_hit(const GrownMesh& grown, const Vec3& p) {
  return grown.mesh.find_hit(p, grown.by);
}

/// A shape that is thicker on the side where bodies are, so that it holds at its surface the middle of what is twice as
/// thick. A bowl is so inside, not at its rim.
inline PlaneShape grown(const PlaneShape& plane, double by) {
  return {plane.point + by * plane.normal, plane.normal};
}
inline Bowl grown(const Bowl& bowl, double by) {
  return {bowl.centre, bowl.axis, bowl.radius - by};
}
inline SphereShape grown(const SphereShape& sphere, double by) {
  return {sphere.centre, sphere.radius + by};
}
inline PreparedCylinder grown(const PreparedCylinder& cylinder, double by) {
  return {{cylinder.centre, cylinder.axis, cylinder.radius + by, cylinder.length + 2 * by}, cylinder.is_end_buried};
}
inline GrownMesh grown(const MeshCollider& mesh, double by) {
  return {mesh, by};
}

/// A shape grown for a vertex of cloth: by half of the thickness, where the vertex starts the step at least as far off.
/// Where it starts nearer, it comes to its distance little by little, without the speed of a push.
/// @param was  where the vertex starts, in the collider's own coordinates, carried along
template <typename Shape>
auto grown_for(const Shape& shape, double half_thickness, const Vec3& was) {
  constexpr double kPart = 1.0 / 50;
  const std::optional<Hit> hit = find_hit(grown(shape, half_thickness), was);
  const double missing = hit ? hit->depth - kPart * half_thickness : 0.0;
  return grown(shape, half_thickness - std::clamp(missing, 0.0, half_thickness));
}

/// @throws Error  when a shape, a motion or a friction is impossible; it names which
std::vector<PreparedCollider> prepare_colliders(std::span<const Collider> colliders);

/// Where a mesh or a cylinder stands on another collider, or in it, no way out leads through the faces between them.
/// Only for those that never move. O(triangles log n).
/// @param element_size  of what is to come out [m]: a twentieth of it may be between the two
std::vector<PreparedCollider> bury_faces(double element_size, std::vector<PreparedCollider> colliders);

/// @throws Error  when a motion is impossible
void check_motion(const std::string& where, const Motion& motion);

/// Whether certainly no point of a box is inside a shape. Most vertices are far from all colliders, and are skipped
/// many at a time.
inline bool is_clear(const PlaneShape& plane, const Eigen::AlignedBox3d& box) {
  const Vec3 middle = box.center() - plane.point, half = 0.5 * box.sizes();
  const double size = box.min().lpNorm<1>() + box.max().lpNorm<1>() + plane.point.lpNorm<1>();
  return plane.normal.dot(middle) - plane.normal.cwiseAbs().dot(half) > 1e-12 * size;
}

inline bool is_clear(const Bowl& bowl, const Eigen::AlignedBox3d& box) {
  const Vec3 farthest = (box.min() - bowl.centre).cwiseAbs().cwiseMax((box.max() - bowl.centre).cwiseAbs());
  return farthest.norm() < (1 - 1e-12) * bowl.radius || is_clear(PlaneShape{bowl.centre, bowl.axis}, box);
}

inline bool is_clear(const SphereShape& sphere, const Eigen::AlignedBox3d& box) {
  return box.exteriorDistance(sphere.centre) * (1 - 1e-12) > sphere.radius;
}

inline bool is_clear(const CylinderShape& cylinder, const Eigen::AlignedBox3d& box) {
  return is_clear(SphereShape{cylinder.centre, std::hypot(cylinder.radius, cylinder.length / 2)}, box);
}

inline bool is_clear(const MeshCollider& mesh, const Eigen::AlignedBox3d& box) {
  return !mesh.bounds().intersects(box);
}

}  // namespace selvage
