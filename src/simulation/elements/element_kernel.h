#pragma once

#include "core/isa.h"
#include "selvage/core/types.h"

namespace selvage {

/// Elements side by side, whatever the width of registers.
inline constexpr int kSolidBatch = 8;
/// Numbers of a vertex in ElementTask::rows.
inline constexpr int kElementRow = 4;

/// Neo-Hookean elements, each with StrainDamping over the step; moduli are times the volume at rest [J]. A place
/// without an element has zeros, and a record behind the last, one a body.
struct alignas(64) SolidBatch {
  Index rows[4][kSolidBatch];               ///< kElementRow times the vertices
  Index elements[kSolidBatch];              ///< their records
  double inverse_edges[3][3][kSolidBatch];  ///< row by row [1/m]
  double inverse_determinant[kSolidBatch];  ///< 1 / (6 rest volume) [1/m^3]
  double mu[kSolidBatch];
  double bulk[kSolidBatch];  ///< lambda + mu
  double damping_mu[kSolidBatch];
  double damping_bulk[kSolidBatch];      ///< lambda
  double squared_start[6][kSolidBatch];  ///< F^T F at the start of the step: 00 11 22 12 02 01
};

/// Gradient of an element by its vertices 1 to 3, each with a number that means nothing; vertex 0 has the negative sum.
struct ElementGradient {
  double of_vertex[3][4];
};

/// Derivatives of an element. What is not here follows: moving all vertices alike changes nothing.
struct ElementDerivatives {
  /// Of its Hessian, for vertices k < l column by column: 01 02 03 12 13 23.
  double blocks[6][9];
  double gradient[3][3];  ///< by vertices 1 to 3
  double unused;
};

struct ElementTask {
  const double* rows;  ///< (kElementRow x n_vertices) positions, each followed by one number that means nothing
  const SolidBatch* batches;
  bool is_damped;
};

// Of the batches [first, last), to the record of each element.
// differentiate_elements: `is_exact` for the exact Hessian, else one that is positive semi-definite as
// HyperelasticMaterial has it, material and damping each for itself.
#define SELVAGE_ELEMENT_KERNEL                                                                               \
  void measure_elements(const ElementTask&, std::int64_t first, std::int64_t last, double* energies);        \
  void pull_elements(const ElementTask&, std::int64_t first, std::int64_t last, ElementGradient* gradients); \
  void differentiate_elements(const ElementTask&, bool is_exact, std::int64_t first, std::int64_t last,      \
                              ElementDerivatives* derivatives);
namespace baseline {
SELVAGE_ELEMENT_KERNEL
}
namespace avx2 {
SELVAGE_ELEMENT_KERNEL
}
namespace avx512 {
SELVAGE_ELEMENT_KERNEL
}
#undef SELVAGE_ELEMENT_KERNEL

}  // namespace selvage
