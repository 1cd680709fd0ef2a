#pragma once

#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"
#include "selvage/simulation/step.h"

#include <memory>

namespace selvage {

/// How the linear systems of Newton's method are solved.
enum class LinearSolver : std::uint8_t {
  kBySize,              ///< directly up to 300 vertices, else by conjugate gradients
  kConjugateGradients,  ///< preconditioned by the blocks of the diagonal
  kDirect,              ///< by a sparse Cholesky factorization
};

struct NewtonOptions : StepOptions {
  int newton_steps = 10;  ///< in a time step, at most; 1 is SPB's algorithm 6
  /// The last Newton step moves no vertex farther than this part of the mean edge, and of what gravity alone moves one
  /// in a time step.
  double tolerance = 0.05;
  LinearSolver linear_solver = LinearSolver::kBySize;
  double linear_tolerance = 1e-3;  ///< of conjugate gradients: residual by right side
};

/// Deformable bodies in time: backward Euler by Newton's method, with the contacts of SPB.
///
/// One step minimises an incremental potential: inertia, elastic energy, damping, contacts and colliders as penalties
/// along the way out (SPB, equation 7), and friction that is smooth near rest. Hessians are made positive
/// semi-definite element by element, so that each Newton step descends, and a line search lets none go too far. Stiff
/// materials and long steps are stable; what is left is reported as StepStatistics::residual. What the solver leaves
/// inside a body or a collider, by the softness of the penalties, is projected in the end as XpbdSolver does.
///
/// Backward Euler takes energy out of what swings, the more the longer the step. An element all of whose vertices are
/// in one point or on one line, with no neighbour to draw it out, stays there: its energy is flat.
///
/// The result is the same, bit for bit, for any number of threads.
/// Sources: Baraff and Witkin 1998; Chen, Diaz, Yuksel 2023 (SPB), section 4 and supplement, algorithm 6.
class NewtonSolver {
 public:
  /// @param model    must outlive the solver
  /// @param initial  where handles start: the state at time 0, also where a run is continued from a later one
  /// @throws Error   when a size, an index, a handle, a collider or an option is impossible, or a mass-spring body is
  ///                 rigid (a compliance is 0); it names which
  NewtonSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
               const NewtonOptions& options);
  NewtonSolver(const Model&& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
               const NewtonOptions& options) = delete;
  ~NewtonSolver();
  NewtonSolver(NewtonSolver&&) noexcept;
  NewtonSolver& operator=(NewtonSolver&&) noexcept;

  /// Takes the state one time step further. What follows depends on the state and the forces alone, not on steps
  /// before.
  /// @param external_forces  (n_vertices) that act in this step besides gravity [N]; empty: none
  /// @throws Error  when a size differs, and naming the first vertex whose position stops being finite
  ///                (is_in_range()); the state is then left as it was
  void step(State& state, std::span<const Vec3> external_forces = {});

  /// As XpbdSolver::contacts().
  std::span<const Contact> contacts() const;

  /// Of the last step.
  const StepStatistics& statistics() const;

  /// What the last step minimised, where its solver stopped [J]: inertia, elastic energy, damping and contacts. Only
  /// values of one step compare. 0: all bodies slept, or there was no step. O(n_vertices + n_elements).
  double objective() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace selvage
