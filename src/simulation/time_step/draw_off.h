#pragma once

#include "selvage/contact/contact_finder.h"
#include "simulation/colliders/collider_surface.h"
#include "simulation/colliders/project_colliders.h"
#include "simulation/step.h"
#include "simulation/step_vertex.h"
#include "simulation/time_step/pieces.h"

namespace selvage {

/// Draws pieces of bodies off the colliders that they are deep in, or that stand deep in them: as a whole, a little in
/// each step, and without speed. Contacts alone would move the elements around the collider, which fold around it and
/// are pressed flat where it is wide.
class DrawOff {
 public:
  /// A step that begins.
  struct Input {
    ContactFinder& finder;
    const Model& model;
    const Pieces& pieces;
    std::span<const PreparedCollider> colliders;
    const Step& step;
    std::span<const double> max_corrections;  ///< (n_vertices) [m] a fifth of the least is the way of a step
  };

  /// A new step: nothing is drawn.
  void begin();

  /// Draws pieces through the solids that they are across: see ways_out_of_solids(). In this step the two do not meet.
  /// Blocked is a way on which a vertex of the boundary runs into another collider. A piece with a vertex that
  /// something holds is not drawn.
  /// @param states    (n_vertices x n_colliders) updated
  /// @param vertices  (n_vertices) moved from where they were predicted
  void leave_solids(const Input& input, const ColliderSurface& surface, std::span<ColliderContactState> states,
                    std::span<StepVertex> vertices);

  /// Draws pieces off the edges of colliders that stand deep in them. To be called after leave_solids(), if
  /// both are. Blocked is a way on which a vertex of the boundary runs into a collider, but for one between that and
  /// another, as under a wall on the floor. A piece with a vertex that something holds is not drawn, but its contacts
  /// lead one way, the shortest.
  void leave_edges(const Input& input, std::span<StepVertex> vertices);

  /// One vertex of each piece that is drawn in the step.
  std::span<const Index> vertices() const { return drawn_; }
  /// Those of them that are drawn through solids.
  std::span<const Index> across() const { return std::span(drawn_).first(across_count_); }

  /// By how far a vertex is drawn in the step [m]. It gives no speed; and what is held in place gets the speed against
  /// it, so that it is not pushed there again and again, and the material around comes to rest.
  Vec3 way_of(Index vertex) const { return ways_.empty() ? Vec3(Vec3::Zero()) : ways_[vertex]; }

  /// (n_vertices) the same of pieces in which edges of colliders are; 0 of those drawn through solids. Empty:
  /// none is drawn.
  std::span<const Vec3> ways_off_edges() const { return ways_off_edges_; }

 private:
  void draw(const Input& input, const PieceWayOff& off, bool is_across, std::span<StepVertex> vertices);

  std::vector<Index> drawn_;
  std::size_t across_count_ = 0;
  std::vector<Vec3> ways_, ways_off_edges_;  ///< (n_vertices) [m]; empty: none is drawn
};

}  // namespace selvage
