#pragma once

#include "selvage/simulation/collider.h"

#include <array>
#include <optional>

namespace selvage {

/// The room that a scene takes: what lies far outside of it is not drawn.
struct Room {
  Vec3 lower, upper;  ///< [m] of all bodies in all frames that are drawn
  Vec3 up = Vec3::UnitZ();

  Vec3 middle() const { return (lower + upper) / 2; }
  double size() const { return (upper - lower).norm(); }
};

/// A collider as surface and edges.
struct ColliderPart {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<VertexTuple<3>> triangles;
  std::vector<std::array<Vec3, 2>> edges;
  /// Containers are seen from inside: walls between the eye and the contents are left out.
  bool one_sided = false;
  bool casts_shadow = false;
  /// Of a plane: towards the side that is free. From behind only a tint is seen.
  std::optional<Vec3> free_side{};
};

/// A collider where it is at a time.
ColliderPart make_collider_part(const Collider& collider, double time, const Room& room);

/// A flat to stand on.
struct Ground {
  double height;                       ///< along `up`, at which it is drawn [m]
  std::optional<std::size_t> plane{};  ///< the collider that it is; none: the floor of a box, or the lowest point
  bool walled = false;                 ///< the floor of a box
};

/// The highest of the planes that face up and stand still, and of the floors of boxes, unless everything lies below it;
/// else the lowest point of the room.
Ground find_ground(std::span<const Collider> colliders, const Room& room);

}  // namespace selvage
