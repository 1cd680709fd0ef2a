#pragma once

#include "core/isa.h"
#include "simulation/vbd/star_kernel.h"

namespace selvage {

/// Triangles of one vertex p with others q and r, side by side: F = (q - p) by_q^T + (r - p) by_r^T. The material is
/// MembraneNeoHookean with StrainDamping, both times the area at rest [J]. A place without a triangle has p for q and
/// r, and zeros: it adds nothing.
struct alignas(64) TriangleStarBatch {
  Index rows[2][kStarBatch];            ///< kStarRow times the vertices q and r
  double by_q[2][kStarBatch];           ///< [1/m]
  double by_r[2][kStarBatch];           ///< [1/m]
  double mu[kStarBatch];                ///< [J]
  double bulk[kStarBatch];              ///< lambda + mu [J]
  double damping_mu[kStarBatch];        ///< [J]
  double damping_bulk[kStarBatch];      ///< lambda [J]
  double squared_start[3][kStarBatch];  ///< F^T F at the start of the step: 00 01 11
};

/// Vertices that flat hinges join with one vertex p: each pulls it with the weight times (q - p), downhill.
struct alignas(64) BendingStarBatch {
  Index rows[kStarBatch];      ///< kStarRow times the vertex q
  double weights[kStarBatch];  ///< [N/m]
};

/// Hinges of one vertex p that are damped: HingeDamping with the other three so ordered that p comes first.
struct alignas(64) HingeStarBatch {
  Index rows[3][kStarBatch];     ///< kStarRow times the vertices q
  double stiffness[kStarBatch];  ///< [J]
  double scale[kStarBatch];      ///< [1/m^3]
  double start[kStarBatch];      ///< [1]
};

/// Sums over the cloth of a vertex, by its position.
struct ClothStarSums {
  double gradient[3];           ///< of triangles
  double hessian[6];            ///< by 00 11 22 01 02 12; positive semi-definite
  double energy;                ///< of triangles [J]
  double least_area;            ///< of triangles, by that at rest; where it is 0, all before means nothing
  double quadratic[3];          ///< the gradient by bending and damped hinges
  double quadratic_hessian[6];  ///< likewise, without bending
};

/// Stars of vertices in a row.
struct ClothStarTask {
  const double* rows;     ///< see StarTask
  const Index* own_rows;  ///< of each star: that of its vertex
  const TriangleStarBatch* triangles;
  const BendingStarBatch* bendings;
  const HingeStarBatch* hinges;
  // (n_stars + 1) of each
  const std::int64_t* first_triangles;
  const std::int64_t* first_bendings;
  const std::int64_t* first_hinges;
  bool is_damped;
};

// Sums of the star of one vertex, and the energy of its triangles with the vertex elsewhere.
#define SELVAGE_CLOTH_STAR_KERNEL                                             \
  void sum_cloth_star(const ClothStarTask&, Index star, ClothStarSums& sums); \
  void measure_cloth_star(const ClothStarTask&, Index star, const double at[3], double& energy);
namespace baseline {
SELVAGE_CLOTH_STAR_KERNEL
}
namespace avx2 {
SELVAGE_CLOTH_STAR_KERNEL
}
namespace avx512 {
SELVAGE_CLOTH_STAR_KERNEL
}
#undef SELVAGE_CLOTH_STAR_KERNEL

}  // namespace selvage
