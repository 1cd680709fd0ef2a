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
  /// @param model  must outlive this
  explicit FreeMomentum(const Model& model);

  const Pieces& pieces() const { return pieces_; }

  /// A new step: nothing acts on anything, but pieces that share a vertex, and pins.
  void begin() { groups_ = fixed_groups_; }
  /// Vertices of bodies, or of bodies and colliders, act on one another.
  void join(std::span<const Contact> contacts);
  void join(std::span<const ZoneLink> links);
  /// Something from outside acts on a vertex.
  void hold(Index v) { groups_.join(node_of(v), outside()); }
  /// Something from outside acts on all vertices of which `is_held` says so. Parallel, O(n).
  template <typename IsHeld>
  void hold_if(IsHeld&& is_held) {
    const std::vector<std::uint8_t> held = pieces_.pieces_with(is_held);
    for (Index p = 0; p < pieces_.count(); ++p)
      if (held[p] != 0) groups_.join(p, outside());
  }

  /// What groups that nothing holds have before the step. O(n) where there is one.
  /// @param positions    (n_vertices) at the start of the step [m]
  /// @param velocity_of  by the number of a vertex: by inertia and outer forces [m/s]
  template <typename VelocityOf>
  void keep(std::span<const Vec3> positions, VelocityOf&& velocity_of) {
    find_free();
    if (any_free_) before_ = momentum_of_groups(positions, velocity_of);
  }

  /// Gives back to these groups what they had. O(n) where there is one.
  /// @param positions   (n_vertices) at the end of the step [m]
  /// @param velocities  (n_vertices) [m/s]; updated
  void restore(std::span<const Vec3> positions, std::span<Vec3> velocities) const;

 private:
  Index outside() const { return pieces_.count(); }
  /// What belongs to no piece, such as a collider, acts as from outside.
  Index node_of(Index v) const { return pieces_.of_vertex(v) == kNone ? outside() : pieces_.of_vertex(v); }
  void find_free();

  /// (n_pieces) of a group at its first piece.
  template <typename VelocityOf>
  std::vector<MomentumSums> momentum_of_groups(std::span<const Vec3> positions, VelocityOf&& velocity_of) const {
    std::vector<MomentumSums> sums = pieces_.momentum(
        positions, [&](Index piece) { return group_of_[piece] != kNone; }, velocity_of);
    for (Index p = 0; p < pieces_.count(); ++p)
      if (group_of_[p] != kNone && group_of_[p] != p) sums[group_of_[p]].add(sums[p]);
    return sums;
  }

  Pieces pieces_;
  UnionFind fixed_groups_, groups_;  ///< of pieces; the last is what acts from outside
  std::vector<Index> group_of_;      ///< (n_pieces) its first piece; kNone: held
  bool any_free_ = false;
  std::vector<MomentumSums> before_;  ///< (n_pieces) see momentum_of_groups()
};

}  // namespace selvage
