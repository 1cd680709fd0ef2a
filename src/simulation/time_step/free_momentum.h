#pragma once

#include "core/union_find.h"
#include "selvage/contact/contact.h"
#include "simulation/time_step/pieces.h"
#include "simulation/time_step/step_gate.h"

namespace selvage {

/// Keeps the momentum and the angular momentum of bodies that nothing from outside acts on. Solvers change them: forces
/// act where vertices are at the end of a step, a contact acts beside its point where masses differ, and sweeps over
/// vertices end before what two do to one another is the same.
///
/// Pieces that act on one another in a step are a group. A group that neither a collider, nor a handle, nor a pinned or
/// sleeping vertex acts on has the momentum, and the angular momentum about its centre of mass, that it would have by
/// inertia and outer forces alone. restore() gives them back by a rigid motion of the whole group: of all changes of
/// its velocities that do so the least, weighed by masses.
class FreeMomentum {
 public:
  explicit FreeMomentum(const Model& model);

  const Pieces& pieces() const { return pieces_; }

  /// A new step: nothing acts on anything, but pieces that share a vertex, and pins.
  void begin() { groups_ = fixed_groups_; }
  /// Vertices of bodies, or of bodies and colliders, act on one another.
  void join(std::span<const Contact> contacts);
  void join(std::span<const ZoneLink> links);
  /// Something from outside acts on a vertex.
  void hold(Index v) { groups_.join(node_of(v), outside()); }

  /// Gives back to groups that nothing holds what they had. O(n) where there is one.
  /// @param start       (n_pieces) at the start of the step
  /// @param gained      velocity that all gain in the step by inertia and outer forces alone [m/s]
  /// @param kept        of that and of the velocities at the start: by damping
  /// @param positions   (n_vertices) at the end of the step [m]
  /// @param velocities  (n_vertices) [m/s]; updated
  void restore(std::span<const MomentumSums> start, const Vec3& gained, double kept, std::span<const Vec3> positions,
               std::span<Vec3> velocities);

 private:
  Index outside() const { return pieces_.count(); }
  /// What belongs to no piece, such as a collider, acts as from outside.
  Index node_of(Index v) const { return pieces_.of_vertex(v) == kNone ? outside() : pieces_.of_vertex(v); }
  bool find_free();
  void add_up(std::span<MomentumSums> of_pieces) const;

  Pieces pieces_;
  UnionFind fixed_groups_, groups_;  ///< of pieces; the last is what acts from outside
  std::vector<Index> group_of_;      ///< (n_pieces) its first piece; kNone: held
};

}  // namespace selvage
