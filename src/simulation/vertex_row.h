#pragma once

namespace selvage {

/// A vertex as solvers move it: one load of a register.
struct alignas(32) VertexRow {
  double position[3];   ///< [m]
  double inverse_mass;  ///< [1/kg]; 0: moved by nothing
};

}  // namespace selvage
