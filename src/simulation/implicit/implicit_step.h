#pragma once

#include "simulation/implicit/incremental_potential.h"
#include "simulation/time_step/time_step.h"

#include <functional>

namespace selvage {

/// Moves x towards a minimum of the potential. `is_guess`: x is where the step begins, not where an earlier call ended.
using Minimizer = std::function<void(IncrementalPotential& potential, bool is_guess, std::vector<Vec3>& x)>;

/// A time step of an implicit solver, around its minimiser: in the order of TimeStep.
///
/// Contacts are found on the way to where inertia leads. When the minimum is found, what meets on the way to it, and
/// vertices that are inside colliders there, are added, and the minimum is sought again, a few times. In the end
/// contacts by CCD and colliders are projected: penalties give way a little.
class ImplicitStep {
 public:
  /// As TimeStep and IncrementalPotential.
  ImplicitStep(const Model& model, const State& initial, std::vector<Handle> handles,
               std::span<const Collider> colliders, const StepOptions& options);

  void step(State& state, std::span<const Vec3> external_forces, const Minimizer& minimize);

  const TimeStep& time_step() const { return time_step_; }
  const IncrementalPotential& potential() const { return potential_; }
  StepStatistics& statistics() { return time_step_.statistics(); }
  /// See NewtonSolver::objective().
  double objective() const { return has_stepped_ ? potential_.energy(x_) : 0; }
  /// Mean length of the elements' edges at rest [m].
  double mean_edge() const { return mean_edge_; }

 private:
  void guess(const State& state);
  bool renew_terms();
  void place();
  void project();

  const Model& model_;

  TimeStep time_step_;
  IncrementalPotential potential_;
  double mean_edge_;
  bool has_stepped_ = false;  ///< the last step was solved: not all slept
  std::vector<Vec3> x_;       ///< (n_vertices)
  std::vector<OffsetTerm> collider_terms_;
  std::vector<std::uint8_t> has_collider_term_;  ///< (n_vertices)
  std::vector<Contact> impacts_;
};

}  // namespace selvage
