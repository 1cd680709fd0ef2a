#pragma once

#include "selvage/contact/friction.h"
#include "selvage/simulation/motion.h"

#include <variant>

namespace selvage {

/// The side of a plane to which `normal` points is free.
struct PlaneShape {
  Vec3 point = Vec3::Zero();  ///< [m]
  Vec3 normal = Vec3::UnitZ();
};

/// A container: everything stays inside a box.
struct BoxContainer {
  Vec3 lower, upper;  ///< [m]
};

/// A half ball hollowed out of all that lies below the rim: the flat through `centre` across `axis`.
struct Bowl {
  Vec3 centre = Vec3::Zero();  ///< [m] of the ball
  Vec3 axis = Vec3::UnitZ();   ///< upwards
  double radius = 1;           ///< [m]
};

struct SphereShape {
  Vec3 centre = Vec3::Zero();  ///< [m]
  double radius = 1;           ///< [m]
};

/// Solid, with flat ends.
struct CylinderShape {
  Vec3 centre = Vec3::Zero();  ///< [m] the middle
  Vec3 axis = Vec3::UnitZ();
  double radius = 1;  ///< [m]
  double length = 1;  ///< [m]
};

/// A solid of a closed surface, triangles outward. Where no two of them have a vertex in common, as in STL, vertices in
/// the same place are taken as one.
struct MeshShape {
  std::vector<Vec3> positions;  ///< [m]
  std::vector<VertexTuple<3>> triangles;
};

/// A solid whose surface changes its form by key frames, as a dancer does. The surface is closed, its triangles face
/// outward and share their vertices.
struct KeyframedShape {
  std::vector<VertexTuple<3>> triangles;
  std::vector<double> times;                 ///< [s] of the key frames, ascending; at least one
  std::vector<std::vector<Vec3>> positions;  ///< (n_times) of all vertices [m]

  /// The surface at a time: linear between key frames, and at rest before the first and after the last. O(n).
  MeshShape at(double time) const;
};

/// A solid or container that moves by its motion, whatever meets it; rigid, but for a KeyframedShape. It keeps the
/// vertices of bodies out of its shape, or inside for a container; and its edges, corners and narrow round sides out of
/// bodies, where contacts are searched for (DetectionMode).
struct Collider {
  std::variant<PlaneShape, BoxContainer, Bowl, SphereShape, CylinderShape, MeshShape, KeyframedShape> shape;
  Motion motion{};
  Friction friction{.static_coefficient = 0.3, .dynamic_coefficient = 0.2};
};

}  // namespace selvage
