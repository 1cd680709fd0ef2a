#pragma once

#include "selvage/contact/contact.h"
#include "selvage/simulation/model.h"
#include "simulation/time_step/pieces.h"

namespace selvage {

/// Lets bodies that were in one another part without flying off. While they get out they are pressed to a part of their
/// volume, and that energy would throw them apart.
///
/// Bodies part in steps in which a point of one is sent out of another, and for a quarter of a second after the last of
/// these. Those that are near one another, by their boxes, are a group. It is no faster than by inertia and outer
/// forces alone: a floor that bodies are pushed into gives it no speed. Once a body is out, what it does beside the
/// rigid motion of its group is damped, so that the group keeps its momentum and its spin. In the steps before nothing
/// is damped: bodies that stop between two steps stay caught in one another.
///
/// All that lasts from step to step is State::rest_times, which is negative while a body parts. The same bits for any
/// number of threads.
class Parting {
 public:
  /// @param model  must outlive this, and so must
  /// @param body_of  (n_vertices), as by bodies_of_vertices()
  Parting(const Model& model, std::span<const Index> body_of) : model_(model), body_of_(body_of) {}

  /// O(contacts), and O(n) while bodies part.
  /// @param start     (n_pieces) at the start of the step
  /// @param gained    velocity that all gain in the step by inertia and outer forces alone [m/s]
  /// @param contacts  of the step
  /// @param state     at the end of the step; updated
  void finish(double step, const Pieces& pieces, std::span<const MomentumSums> start, const Vec3& gained,
              std::span<const Contact> contacts, State& state) const;

 private:
  std::vector<Index> groups_of(std::span<const Contact> met, const State& state) const;
  bool lies_between_bodies(const Contact& contact) const;

  const Model& model_;
  std::span<const Index> body_of_;
};

}  // namespace selvage
