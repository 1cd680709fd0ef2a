#pragma once

#include "selvage/simulation/model.h"
#include "simulation/colliders/prepared_collider.h"

namespace selvage {

/// What of colliders can reach in between the vertices of a body: their edges, corners and narrow round sides, as
/// triangles for ContactFinder. Planes, boxes hollow inside and round sides that are wide against the bodies' elements
/// have nothing of the kind: vertices that are kept out keep out all else.
struct ColliderSurface {
  /// In the own coordinates of their colliders [m]: those of key-framed ones at the end of the step.
  std::vector<Vec3> positions;
  std::vector<Vec3> start_positions;        ///< the same at its start; empty where no collider is key-framed
  std::vector<VertexTuple<3>> triangles;    ///< outward
  std::vector<Index> collider_of_vertices;  ///< (n_positions)

  /// With numbers of vertices that follow others.
  std::vector<VertexTuple<3>> triangles_after(Index vertex_count) const;
};

/// A length by which bodies are divided: the least of their mean edges at rest [m]; 0 without an element. O(n).
double element_size_of(const Model& model);

/// The surface lies behind that of the colliders, by half a percent of the element size or less where a shape is thin:
/// bodies whose vertices rest on a collider do not touch it. Edges are divided where they are longer than an element.
/// A key-framed surface is taken whole, with its own triangles.
/// O(n log n) for the triangles of colliders and the parts of their edges.
ColliderSurface make_collider_surface(std::span<const PreparedCollider> colliders, double element_size);

/// Moves what belongs to key-framed colliders to where these are in their step. O(n).
void place_keyframed(std::span<const PreparedCollider> colliders, double element_size, ColliderSurface& surface);

}  // namespace selvage
