#pragma once

#include "core/unset_vector.h"
#include "simulation/implicit/block_matrix.h"

namespace selvage {

/// Conjugate gradients, preconditioned by the blocks of the diagonal.
///
/// Products are with the matrix rounded to single precision, which is half as much to read, and read is what they do.
/// What that and rounding leave is measured with the matrix itself, and solved for again. The same bits for any number
/// of threads and every instruction set.
class ConjugateGradients {
 public:
  /// x with matrix x = right side.
  /// @param tolerance  length of the residual by that of the right side
  /// @return iterations; at 2,000, or where the matrix is not positive definite, x is what has been reached
  std::int64_t solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, double tolerance, Eigen::VectorXd& x);

 private:
  void take_over(const BlockMatrix& matrix);
  std::int64_t correct(const BlockMatrix& matrix, double least, std::int64_t most, Eigen::VectorXd& x);
  double multiply(const BlockMatrix& matrix);

  UnsetVector<float> blocks_;
  std::vector<Eigen::Matrix3d> inverses_;  ///< of the blocks of the diagonal
  Eigen::VectorXd residual_, scaled_, direction_, product_;
  std::vector<double> sums_, other_sums_;  ///< of runs of rows
};

}  // namespace selvage
