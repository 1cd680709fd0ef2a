#pragma once

#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"
#include "selvage/simulation/step.h"

#include <memory>

namespace selvage {

struct VbdOptions : StepOptions {
  /// Sweeps over all vertices in a time step, at most; and a quarter of them each time that it finds further contacts.
  int iterations = 10;
  /// StepStatistics::residual at which a step is done with before [m]; 0: after all iterations. To know it costs about
  /// a quarter of a sweep more.
  double residual = 0;
};

/// Deformable bodies in time: backward Euler by vertex block descent, with the contacts of SPB.
///
/// The same incremental potential as NewtonSolver's, minimised vertex by vertex: each moves by one Newton step of its
/// own, with all others held, or at cloth and contacts by the part of it with which the energy falls. Vertices of one
/// colour share no element, triangle or hinge of cloth and are moved at the same time; contacts between them see where
/// they were before, and count as so much stiffer that this cannot raise their energy. A sweep costs little and is
/// never unstable, but what is far away is felt only after many: stiff bodies look softer than they are. For exact
/// answers use NewtonSolver.
///
/// The result is the same, bit for bit, for any number of threads.
/// Source: Chen, Liu, Yang, Yuksel 2024, Vertex block descent; without its acceleration.
class VbdSolver {
 public:
  /// As NewtonSolver.
  VbdSolver(const Model& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
            const VbdOptions& options);
  VbdSolver(const Model&& model, const State& initial, std::vector<Handle> handles, std::vector<Collider> colliders,
            const VbdOptions& options) = delete;
  ~VbdSolver();
  VbdSolver(VbdSolver&&) noexcept;
  VbdSolver& operator=(VbdSolver&&) noexcept;

  /// As NewtonSolver::step().
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
