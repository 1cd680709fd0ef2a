#pragma once

#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"
#include "selvage/simulation/step.h"

#include <memory>

namespace selvage {

struct XpbdOptions : StepOptions {
  int iterations = 3;  ///< of the material solve in a step
};

/// Deformable bodies in time: XPBD with the contacts of SPB.
///
/// One step is SPB's supplement, algorithm 5, but that contacts are found after the first half of the iterations and
/// projected then and after each of the others, not once. The material is solved by Gauss-Seidel over blocks of
/// elements: blocks of one colour share no vertex and are solved at the same time, inside a block by as many lanes as
/// registers have. The result is the same, bit for bit, for any number of threads and on any instruction set.
/// Sources: Macklin, Mueller, Chentanez 2016 (XPBD); Macklin and Mueller 2021; Chen, Diaz, Yuksel 2023 (SPB).
class XpbdSolver {
 public:
  /// @param model    must outlive the solver
  /// @param initial  where handles start: the state at time 0, also where a run is continued from a later one
  /// @throws Error   when a size, an index, a handle, a collider or an option is impossible; it names which
  XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
             const XpbdOptions& options);
  ~XpbdSolver();
  XpbdSolver(XpbdSolver&&) noexcept;
  XpbdSolver& operator=(XpbdSolver&&) noexcept;

  /// Takes the state one time step further. What follows depends on the state alone, not on steps before.
  /// @throws Error  naming the first vertex whose position stops being finite (is_in_range()); the state is then left
  /// as it was
  void step(State& state);

  /// Of the last step.
  const StepStatistics& statistics() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace selvage
