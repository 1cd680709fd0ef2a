#pragma once

#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"
#include "selvage/simulation/step.h"

#include <functional>
#include <memory>

namespace selvage {

struct XpbdOptions : StepOptions {
  int iterations = 3;  ///< of the material solve in a step
};

/// Vertices in the middle of a step, for a constraint of the user's: where they are, and how easily they move.
class StepVertices {
 public:
  /// @param rows  (n_vertices x 4) position [m] and inverse mass [1/kg] of each
  StepVertices(double* rows, Index count) : rows_(rows), count_(count) {}

  Index size() const { return count_; }
  /// May be assigned to. [m]
  Eigen::Map<Vec3> position(Index vertex) const { return Eigen::Map<Vec3>(rows_ + 4 * std::ptrdiff_t{vertex}); }
  /// 0: pinned, held by a handle, or without element; such a vertex must not be moved. [1/kg]
  double inverse_mass(Index vertex) const { return rows_[4 * std::ptrdiff_t{vertex} + 3]; }

 private:
  double* rows_;
  Index count_;
};

/// Called in each iteration of a step, numbered from 0, after the material and before contacts and colliders.
using UserConstraint = std::function<void(const StepVertices& vertices, int iteration)>;

/// Deformable bodies and cloth in time: XPBD with the contacts of SPB.
///
/// One step is SPB's supplement, algorithm 5, but that contacts are found after the first half of the iterations and
/// projected then and after each of the others, not once. The material is solved by Gauss-Seidel over blocks of
/// elements: blocks of one colour share no vertex and are solved at the same time, inside a block by as many lanes as
/// registers have. The result is the same, bit for bit, for any number of threads and on any instruction set. Beyond
/// the papers: while an element is inverted its volume resists a thousand times as much, as its energy alone may hold
/// it inside out; by DetectionMode::kHybrid in bodies that start the step tangled, else in all. Sources: Macklin,
/// Mueller, Chentanez 2016 (XPBD); Macklin and Mueller 2021; Chen, Diaz, Yuksel 2023 (SPB).
///
/// Example, built and run by the tests:
/// @include xpbd_solver.cpp
class XpbdSolver {
 public:
  /// @param model    must outlive the solver
  /// @param initial  where handles start: the state at time 0, also where a run is continued from a later one
  /// @throws Error   when a size, an index, a handle, a collider or an option is impossible; it names which
  XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
             const XpbdOptions& options);
  XpbdSolver(const Model&& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
             const XpbdOptions& options) = delete;
  ~XpbdSolver();
  XpbdSolver(XpbdSolver&&) noexcept;
  XpbdSolver& operator=(XpbdSolver&&) noexcept;

  /// Adds a constraint of the user's to all steps that follow; an empty function takes it away.
  ///
  /// The constraint moves vertices so that it holds, or holds better. Velocities follow from the moves; so momentum is
  /// kept where each move is in proportion to the vertex's inverse mass, and the moves weighed by mass sum to zero.
  /// Contacts and colliders are projected after it and may undo a part: more iterations bring both together.
  ///
  /// The function is called on the thread that calls step(), once an iteration: what it takes is added to the step, and
  /// results are the same bits from run to run as far as its own are. Without one a step is the same, bit for bit, as
  /// before and costs nothing more. What it throws leaves step(), and the state as it was.
  void set_constraint(UserConstraint constraint);

  /// Takes the state one time step further. What follows depends on the state, the forces and the user's constraint
  /// alone, not on steps before.
  /// @param external_forces  (n_vertices) that act in this step besides gravity [N]; empty: none
  /// @throws Error  when a size differs, and naming the first vertex whose position stops being finite
  ///                (is_in_range()); the state is then left as it was
  void step(State& state, std::span<const Vec3> external_forces = {});

  /// Of the last step, as found in the middle of it and projected until its end, in the order of
  /// ContactFinder::find_contacts(). Boundary faces are numbered as in TetMesh::boundary_faces() of the model's mesh,
  /// then triangles of cloth, edges as in the TriangleMesh of all of these, surface_of(). Vertices, faces and edges
  /// with higher numbers are of colliders: of their edges, corners and narrow round sides. Valid until the next step.
  std::span<const Contact> contacts() const;

  /// Of the last step.
  const StepStatistics& statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
