#pragma once

#include "selvage/simulation/newton.h"
#include "simulation/implicit/block_matrix.h"

#include <memory>
#include <optional>

namespace selvage {

/// Solves symmetric positive definite systems of one pattern after another. The same bits for any number of threads.
class LinearSystem {
 public:
  /// @param tolerance  of conjugate gradients: length of the residual by that of the right side
  LinearSystem(LinearSolver kind, double tolerance);
  ~LinearSystem();
  LinearSystem(LinearSystem&&) noexcept;
  LinearSystem& operator=(LinearSystem&&) noexcept;

  /// x with matrix x = right side.
  /// @param new_pattern  whether the matrix has other blocks than in the call before
  /// @return iterations of conjugate gradients; 0: solved directly; nothing where the matrix is not positive definite,
  ///         as far as that is noticed
  std::optional<std::int64_t> solve(const BlockMatrix& matrix, bool new_pattern, const Eigen::VectorXd& right,
                                    Eigen::VectorXd& x);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace selvage
