#pragma once

#include "contact/ways_out/path_contact.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/mesh/triangle_mesh.h"

namespace selvage {

/// A direction in which a piece of the mesh gets off the colliders that stand in it.
struct WayOff {
  Vec3 direction;  ///< of the piece, unit
  double length;   ///< by how far it has to move [m]
  double way;      ///< the longest of a collider's point out of the piece, the other way [m]
};

/// Ways by which pieces of the mesh get off colliders as a whole.
///
/// A plate that stands deep in a body has points whose shortest ways lead to either side: what they move folds around
/// the plate's edges, is pressed flat, and stays. As a whole the body can leave, mostly along the plate.
class WaysOffColliders {
 public:
  /// @param rest_positions  (n_vertices) of the mesh [m]
  /// @param surface         of the mesh and, from `body_faces` on, of colliders
  WaysOffColliders(const TetMesh& mesh, std::span<const Vec3> rest_positions, const TriangleMesh& surface,
                   Index body_faces);

  /// A new step: no piece has a way off.
  void begin_step() {
    chosen_.clear();
    let_in_.clear();
  }

  /// Lets a piece and parts of colliders into each other, both by vertices of them.
  void let_in(Index of_mesh, std::span<const Index> of_colliders);

  /// Whether a point is of a collider that has been let into the piece that the point is in.
  bool is_let_in(const PenetratingPoint& point) const;

  /// Chooses a way off for each piece that some point of a collider stands in by more than a quarter of an edge,
  /// whatever the direction: the shortest that is not blocked. A piece has to move until the last vertex of the
  /// collider that is beside it is beyond a face by which some point leaves it: an upper bound where the piece is
  /// convex. O(elements), and for each of some thirty directions O(points (elements on their ways + vertices beside)).
  /// @param positions    (n_vertices) at the start of the step, of the mesh, then of colliders [m]
  /// @param points       of colliders' surfaces, each in its element
  /// @param is_blocked   by a vertex of the piece and the way by which the piece would move [m]
  std::vector<PieceWayOff> choose(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                  const std::function<bool(Index, const Vec3&)>& is_blocked);

  /// Whether no piece has a way off or has been let into a collider.
  bool empty() const { return chosen_.empty() && let_in_.empty(); }

  /// Replaces the ways out of colliders' points in pieces with a way off: straight, the other way.
  /// @param paths  (n_points) updated
  void apply(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
             std::span<BoundaryPath<3>> paths) const;

  /// Whether a point of a collider, in a piece with a way off, is in an element around which one was pressed to less
  /// than three tenths of its rest volume at the start of the step: it would be pressed on.
  bool waits(const PenetratingPoint& point) const;

  /// Whether a vertex of the mesh is of a piece, and another of a part of a collider, that have been let in.
  bool lets_in(Index of_mesh, Index of_collider) const;

 private:
  /// By the number of the piece.
  struct Chosen {
    Index piece;
    Vec3 direction;
  };

  const Chosen* chosen_for(const PenetratingPoint& point) const;
  double edge_at(Index element) const;
  std::vector<BoundaryPath<3>> straight_ways(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                             const Vec3& direction) const;
  std::vector<Vec3> beside(std::span<const Vec3> positions, std::span<const PenetratingPoint> points) const;
  std::vector<WayOff> ways_of(std::span<const Vec3> positions, std::span<const PenetratingPoint> points) const;

  const TetMesh& mesh_;
  std::vector<Vec3> rest_positions_, start_positions_;
  std::vector<Index> pieces_;  ///< (n_elements)
  std::vector<Chosen> chosen_;
  std::vector<std::array<Index, 2>> let_in_;  ///< pieces and parts, ascending
  std::vector<Index> colliders_;  ///< (n_vertices of the surface) the connected part of a collider that each is of
};

}  // namespace selvage
