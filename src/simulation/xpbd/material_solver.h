#pragma once

#include "selvage/simulation/model.h"
#include "simulation/xpbd/material_kernel.h"

namespace selvage {

/// The material solve of a model: Gauss-Seidel over its constraints.
class MaterialSolver {
 public:
  MaterialSolver(const Model& model, double time_step);

  /// Whether solve() needs the vertices at the start of the step.
  bool needs_start() const;

  /// Constraints solved in one iteration.
  std::int64_t constraint_count() const { return blocks_.constraint_count; }

  /// While an element is inverted its volume resists a thousand times as much. Its energy is finite where a vertex
  /// passes through a face, so that what contacts have turned inside out may rest as it is, in a knot of which no
  /// contact gets it out. Of all bodies, or from this call on of those alone that have one of these vertices.
  /// @param vertices  ascending
  void turn_back(std::span<const Index> vertices);

  /// The kernel of the active instruction set.
  static void solve_best(const MaterialTask& task, Index first, Index last);

  /// Iterations of a step from `first` to before `last`; number 0 forgets the step before. The same bits for any
  /// number of threads, and with every kernel.
  void solve(std::span<StepVertex> vertices, std::span<const StepVertex> start, int first, int last,
             void (*kernel)(const MaterialTask&, Index first, Index last) = &solve_best);

 private:
  const Model& model_;
  MaterialBlocks blocks_;
  std::vector<MaterialStep> bodies_;
};

}  // namespace selvage
