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
  void begin_step() { chosen_.clear(); }

  /// Chooses a way off for each piece that some point of a collider stands in by more than a quarter of an edge,
  /// whatever the direction: the shortest that is not blocked. A piece has to move until the last vertex of the
  /// collider that is beside it is beyond a face by which some point leaves it: an upper bound where the piece is
  /// convex. O(elements), and for each of some thirty directions O(points (elements on their ways + vertices beside)).
  /// @param positions    (n_vertices) at the start of the step, of the mesh, then of colliders [m]
  /// @param locator      of the mesh, there
  /// @param on_surfaces  of colliders' surfaces, each in its element
  /// @param on_faces     inside or not; they count for pieces in which more of them are than of the others
  /// @param is_blocked   by a vertex of the piece and the way by which the piece would move [m]
  std::vector<PieceWayOff> choose(std::span<const Vec3> positions, const PointLocator<3>& locator,
                                  std::span<const PenetratingPoint> on_surfaces,
                                  std::span<const ColliderPoint> on_faces,
                                  const std::function<bool(Index, const Vec3&)>& is_blocked);

  bool empty() const { return chosen_.empty(); }

  /// Replaces the ways out of colliders' points in pieces with a way off: straight, the other way.
  /// @param paths  (n_points) updated
  void apply(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
             std::span<BoundaryPath<3>> paths) const;

  /// Whether a point of a collider, in a piece with a way off, is in an element around which one was pressed to less
  /// than three tenths of its rest volume at the start of the step: it would be pressed on.
  bool waits(const PenetratingPoint& point) const;

  /// Whether a vertex of the mesh is of a piece with a way off, and another of a collider that stands all through it:
  /// then the edges of the collider have to run into the piece on that way.
  bool lets_in(Index of_mesh, Index of_collider) const;

 private:
  /// By the number of the piece.
  struct Chosen {
    Index piece;
    Vec3 direction;
    std::vector<Index> parts;  ///< of colliders that stand all through it, ascending
  };

  /// The shortest first, and the colliders' points that are beside the piece.
  struct Ways {
    std::vector<WayOff> ways;
    std::vector<Vec3> near;
  };

  const Chosen* chosen_for(const PenetratingPoint& point) const;
  double edge_at(Index element) const;
  std::vector<BoundaryPath<3>> straight_ways(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                             const Vec3& direction) const;
  std::vector<Index> parts_of(std::span<const PenetratingPoint> points) const;
  std::vector<Vec3> beside(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                           std::span<const ColliderPoint> on_faces) const;
  Ways ways_of(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
               std::span<const ColliderPoint> on_faces) const;
  bool ends_inside(const PointLocator<3>& locator, std::span<const Vec3> near, Index piece, const WayOff& off) const;

  const TetMesh& mesh_;
  std::vector<Vec3> rest_positions_, start_positions_;
  std::vector<Index> pieces_;  ///< (n_elements)
  std::vector<Chosen> chosen_;
  std::vector<Index> colliders_;  ///< (n_vertices of the surface) the connected part of a collider that each is of
};

}  // namespace selvage
