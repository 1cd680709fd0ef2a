#pragma once

#include "simulation/implicit/incremental_potential.h"
#include "simulation/newton/linear_solver.h"

namespace selvage {

struct NewtonLimits {
  int steps;          ///< at most
  double least_move;  ///< done where a step moves no vertex farther [m]
  double near_move;   ///< where a step moves no vertex farther, the next takes the exact Hessian [m]
};

struct NewtonReport {
  std::int64_t steps = 0;
  std::int64_t linear_iterations = 0;
  bool is_done = false;  ///< the last step moved no vertex farther than the least move
};

/// Newton's method with a line search, from x on.
///
/// The Hessian is made positive semi-definite element by element, but near the solution, where the exact one makes the
/// convergence quadratic; where that turns out indefinite, it is not used.
/// The line search halves a step until the energy falls by 1/10,000 of what its slope promises (Armijo). Where the
/// promise drowns in the rounding of the energy, the step is taken as it is.
///
/// Contacts are taken as new: see IncrementalPotential::renew_friction().
NewtonReport minimize(IncrementalPotential& potential, LinearSystem& system, const NewtonLimits& limits,
                      BlockMatrix& matrix, std::vector<Vec3>& x);

}  // namespace selvage
