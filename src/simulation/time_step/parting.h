#pragma once

#include "selvage/contact/contact.h"
#include "selvage/simulation/model.h"
#include "simulation/time_step/pieces.h"

namespace selvage {

/// Lets bodies that were in one another, or in a collider, come out without flying off. On their way they are pressed
/// to a part of their volume, and that energy would throw them.
///
/// Bodies part in steps in which a point of one is sent out of another, or one starts deep in a collider that stands
/// still or across one that may move, and for a quarter of a second after the last of these. Those that are near one
/// another, by their boxes, are a group. It is no faster than by inertia and outer forces alone: a floor that bodies
/// are pushed into gives it no speed. Once a body is out, what it does beside the rigid motion of its group is damped,
/// so that the group keeps its momentum and its spin. In the steps before nothing is damped: bodies that stop between
/// two steps stay caught in one another.
///
/// All that lasts from step to step is State::rest_times, which is negative while a body parts. The same bits for any
/// number of threads.
class Parting {
 public:
  /// @param model    must outlive this, and so must
  /// @param body_of  (n_vertices), as by bodies_of_vertices()
  Parting(const Model& model, std::span<const Index> body_of, double time_step, const Vec3& gravity)
      : model_(model), body_of_(body_of), time_step_(time_step), gained_(time_step * gravity) {}

  /// Whether a body parts at the start of a step, or may: in the first, and where the model names no bodies.
  bool is_any(const State& state) const;

  /// The part of its depth in a collider that stands still by which a vertex comes out in a step at most. Where bodies
  /// part, those that are deeper come out by more, so that elements keep their order: where all come out alike, those
  /// that are out wait on the surface, and the elements behind them are pressed flat between these and the rest, which
  /// little undoes.
  double depth_share(const State& state) const;

  /// O(contacts), and O(n + bodies^2) while bodies part.
  /// @param start     (n_pieces) at the start of the step
  /// @param contacts  of the step
  /// @param deep      vertices that start it deep in colliders that stand still, or are of pieces that start it across
  /// one
  /// @param state     at the end of the step; updated
  void finish(const Pieces& pieces, std::span<const MomentumSums> start, std::span<const Contact> contacts,
              std::span<const Index> deep, State& state) const;

 private:
  std::vector<Index> groups_of(std::span<const Contact> met, const State& state) const;
  bool lies_between_bodies(const Contact& contact) const;

  const Model& model_;
  std::span<const Index> body_of_;
  double time_step_;
  Vec3 gained_;  ///< velocity that all gain in a step by gravity [m/s]
};

}  // namespace selvage
