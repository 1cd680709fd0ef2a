#pragma once

namespace selvage {

/// A vertex as solvers move it: one load of a register. StepVertices hands these out.
struct alignas(32) StepVertex {
  double position[3];   ///< [m]
  double inverse_mass;  ///< [1/kg]; 0: moved by nothing
};

static_assert(sizeof(StepVertex) == 4 * sizeof(double));

}  // namespace selvage
