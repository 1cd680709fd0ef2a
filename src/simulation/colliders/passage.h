#pragma once

#include "simulation/colliders/prepared_collider.h"

namespace selvage {

/// The points at which a straight way enters a shape and leaves it.
struct Passage {
  Vec3 entry;         ///< [m]
  Vec3 entry_normal;  ///< unit, outward
  Vec3 exit_normal;   ///< the same, where the way leaves for the last time; zero where it ends inside
};

/// The passage of a way that begins outside a shape, or on it but for rounding; nothing where the way misses the shape.
std::optional<Passage> find_passage(const SphereShape& sphere, const Vec3& from, const Vec3& to);
std::optional<Passage> find_passage(const CylinderShape& cylinder, const Vec3& from, const Vec3& to);
std::optional<Passage> find_passage(const MeshCollider& shape, const Vec3& from, const Vec3& to);
/// That of the mesh, with the entry so far in front of it.
std::optional<Passage> find_passage(const GrownMesh& shape, const Vec3& from, const Vec3& to);

/// Whether a point may pass through a shape within a step.
template <typename Shape>
inline constexpr bool kHasFarSide = !std::is_same_v<Shape, PlaneShape> && !std::is_same_v<Shape, Bowl>;

/// Cosine of the angle between the normals at both ends below which a passage led through the shape, not around an edge
/// or over a round side.
inline constexpr double kMaxThroughCosine = -0.5;

/// The way out of a shape for a point that came on a straight way: the shortest way out, or back to the side that the
/// point came from, where that is another side. So it is when a shape thinner than the step's way was passed, or its
/// middle.
template <typename Shape>
std::optional<Hit> find_hit_on_way(const Shape& shape, const Vec3& from, const Vec3& to) {
  const std::optional<Hit> hit = find_hit(shape, to);
  if constexpr (kHasFarSide<Shape>) {
    if (hit && hit->normal.dot(to - from) <= 0) return hit;
    const std::optional<Passage> passage = find_passage(shape, from, to);
    if (!passage || !(passage->entry_normal.dot(hit ? hit->normal : passage->exit_normal) < kMaxThroughCosine))
      return hit;
    const double depth = passage->entry_normal.dot(passage->entry - to);
    if (depth > 0) return Hit{passage->entry_normal, depth};
  }
  return hit;
}

}  // namespace selvage
