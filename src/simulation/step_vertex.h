#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// A vertex as solvers move it: one load of a register. StepVertices hands these out.
struct alignas(32) StepVertex {
  double position[3];   ///< [m]
  double inverse_mass;  ///< [1/kg]; 0: moved by nothing
};

static_assert(sizeof(StepVertex) == 4 * sizeof(double));

inline Eigen::Map<Eigen::Vector3d> position(StepVertex& vertex) {
  return Eigen::Map<Eigen::Vector3d>(vertex.position);
}
inline Eigen::Map<const Eigen::Vector3d> position(const StepVertex& vertex) {
  return Eigen::Map<const Eigen::Vector3d>(vertex.position);
}

}  // namespace selvage
