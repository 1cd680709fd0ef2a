#pragma once

#include "selvage/contact/friction.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/step.h"
#include "simulation/step_vertex.h"

#include <algorithm>

namespace selvage {

/// Pushes of a vertex by a collider in the last step in which there were any. Few vertices meet a collider,
/// so that these are reset one by one when a step first uses them.
struct ColliderContactState {
  FrictionState friction;
  Vec3 normal = Vec3::Zero();   ///< of the last push
  Vec3 way_out = Vec3::Zero();  ///< unit normal where the vertex started the step inside
  double start_depth = 0;       ///< at the start of the step [m]; 0 where that is not to be undone
  double depth_left = 0;        ///< that may be left at the end of the step [m]
  std::int64_t step = -1;       ///< Step::number
  bool waits = false;           ///< it is deep, and its way out leads against that on which its body is drawn
  bool is_let_in = false;       ///< the collider does not act on it in the step

  bool acts(const Step& in) const { return step == in.number && !is_let_in; }
  bool lets_in(const Step& in) const { return step == in.number && is_let_in; }

  /// The part of the push that only undoes the depth at the start of the step.
  ///
  /// @param moved  by how much the vertex has moved in the step: where it was held back, there is less to undo [m]
  Vec3 depenetration(const Vec3& moved) const {
    return std::clamp(moved.dot(way_out), 0.0, std::min(start_depth - depth_left, friction.normal_sum)) * way_out;
  }
};

/// What colliders have pushed in a step, so that nothing else needs to push it back into them.
struct ColliderSupports {
  std::span<ColliderContactState> states{};  ///< (n_vertices x n_colliders); empty: none has pushed any
  std::size_t collider_count = 0;
  std::int64_t step = -1;  ///< Step::number

  /// A move of a vertex but for its parts into colliders that have pushed the vertex in the step.
  Vec3 free_part(Index vertex, const Vec3& move) const {
    return free_part(vertex, move, [](ColliderContactState&, double) {});
  }
  /// The same; these colliders take what is left out as load, for friction.
  Vec3 take_load(Index vertex, const Vec3& move) const {
    return free_part(vertex, move, [](ColliderContactState& state, double load) { state.friction.normal_sum += load; });
  }

 private:
  template <typename Visit>
  Vec3 free_part(Index vertex, Vec3 move, Visit&& visit) const {
    const std::size_t first = static_cast<std::size_t>(vertex) * collider_count;
    for (std::size_t i = first; i < first + collider_count && i < states.size(); ++i) {
      const double load = states[i].step == step ? -states[i].normal.dot(move) : 0;
      if (!(load > 0)) continue;
      move += load * states[i].normal;
      visit(states[i], load);
    }
    return move;
  }
};

/// Over vertices and colliders.
struct ColliderContacts {
  std::vector<Index> pushed;        ///< vertices, once for each push
  std::int64_t started_inside = 0;  ///< first pushes of a step, of vertices that started it inside

  void add(const ColliderContacts& other) {
    pushed.insert(pushed.end(), other.pushed.begin(), other.pushed.end());
    started_inside += other.started_inside;
  }
};

/// Moves vertices out of colliders, which move during the step, to the side that they come from: see
/// find_hit_on_way(). Friction leaves no vertex inside another collider, nor inside a body. Parallel.
///
/// @param max_corrections  (n_vertices) [m] what starts the step inside by more than kContactGap of them comes out
///                         without speed, by so much a step: in one step the material would be pressed flat onto the
///                         surface
/// @param depth_share      but by no more than this part of its depth out of what stands still
/// @param half_thickness   (n_vertices) by which cloth is held off [m]; empty: all is thin
/// @param ejected          (n_vertices) by how much contacts sent vertices out of bodies [m]: friction does not count
///                         it as sliding
/// @param ways             (n_vertices) on which bodies are drawn in the step; empty: none is. A vertex deep in a solid
///                         that would come out against its way waits: the body would hook around the solid
/// @param states           (n_vertices x n_colliders); updated. What is_let_in is not pushed
ColliderContacts project_colliders(std::span<const PreparedCollider> colliders, const Step& step,
                                   std::span<const double> max_corrections, double depth_share,
                                   std::span<const double> half_thickness, std::span<const Vec3> ejected,
                                   std::span<const Vec3> ways, std::span<ColliderContactState> states,
                                   std::span<StepVertex> vertices);

/// Vertices that have started the step deeper in a collider that stands still than they come out by in a step; in the
/// order of their pushes, and more than once.
std::vector<Index> find_deep_vertices(const ColliderContacts& contacts, std::span<const ColliderContactState> states,
                                      std::span<const PreparedCollider> colliders, const Step& step);

/// A vertex that enters or passes a collider in the step.
struct ColliderEntry {
  Index vertex, collider;
};

/// Entries of those of some vertices that end the step deeper in a collider than kContactGap of their largest
/// correction, and than they started it; but for what is let in. Parallel; in order.
/// @param states  (n_vertices x n_colliders)
std::vector<ColliderEntry> find_entries(std::span<const PreparedCollider> colliders, const Step& step,
                                        std::span<const double> max_corrections,
                                        std::span<const ColliderContactState> states, std::span<const Index> vertices,
                                        std::span<const StepVertex> positions);

}  // namespace selvage
