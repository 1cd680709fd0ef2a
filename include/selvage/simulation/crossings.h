#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// How far two bodies of a model stand in one another, or a body in itself. What only touches does not count.
struct BodyPairCrossings {
  Index first = kNone, second = kNone;  ///< bodies, first <= second
  std::int64_t triangle_pairs = 0;      ///< of their boundaries, that cross and share no vertex
  std::int64_t vertices = 0;            ///< of either boundary, inside an element of the other that is not theirs
  std::int64_t edges = 0;               ///< likewise, that run through such an element
  double deepest_vertex = 0;            ///< longest shortest path to the boundary of one of the vertices [m]
  double deepest_edge = 0;              ///< likewise, of a point between the ends of one of the edges [m]
};

/// How far the bodies of a model stand in one another.
struct BodyCrossings {
  std::vector<BodyPairCrossings> pairs;  ///< those that cross, ascending
  BodyPairCrossings total;               ///< of all; a vertex or an edge that is inside several bodies counts once
};

/// How far bodies and one collider stand in one another.
///
/// Counted are depths of more than kMinCrossing of the body's cell, the mean length of its elements' edges at rest.
/// The deepest are the deepest of all, 0 where there are none.
struct ColliderCrossings {
  std::int64_t vertices = 0;    ///< of bodies, inside the collider
  double deepest_vertex = 0;    ///< of them, by its shortest way out of the collider [m]
  std::int64_t points = 0;      ///< of the collider, inside elements
  double deepest_point = 0;     ///< of them, by its shortest path to the boundary [m]
  double deepest_in_cells = 0;  ///< the largest of these depths over the cell of its body
  Index body = kNone;           ///< that body; kNone where nothing is inside

  bool any() const { return vertices > 0 || points > 0; }
  void add(const ColliderCrossings& other);
};

/// Part of a body's cell up to which its depth in a collider counts as contact.
inline constexpr double kMinCrossing = 0.01;

}  // namespace selvage
