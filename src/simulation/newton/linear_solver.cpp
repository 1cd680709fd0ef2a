// Only what Eigen has under the MPL2: its simplicial factorization.
#define EIGEN_MPL2_ONLY

#include "simulation/newton/linear_solver.h"

#include "simulation/newton/conjugate_gradients.h"

#include <Eigen/SparseCholesky>

namespace selvage {

namespace {

/// Vertices up to which a factorization costs less than conjugate gradients.
constexpr Index kMaxDirectVertices = 300;

Eigen::SparseMatrix<double> lower_triangle(const BlockMatrix& matrix) {
  Eigen::SparseMatrix<double> lower(3 * matrix.row_count(), 3 * matrix.row_count());
  std::vector<int> counts(lower.cols(), 0);
  for (Index row = 0; row < matrix.row_count(); ++row)
    for (std::int64_t i = matrix.first[row]; i < matrix.first[row + 1]; ++i)
      for (int k = 0; k < 3; ++k)
        if (matrix.columns[i] >= row) counts[3 * row + k] += matrix.columns[i] == row ? 3 - k : 3;
  lower.reserve(counts);
  // By columns: what the matrix lists by rows, since it is symmetric.
  for (Index row = 0; row < matrix.row_count(); ++row)
    for (std::int64_t i = matrix.first[row]; i < matrix.first[row + 1]; ++i) {
      const Index column = matrix.columns[i];
      if (column < row) continue;
      for (int k = 0; k < 3; ++k)
        for (int l = column == row ? k : 0; l < 3; ++l)
          lower.insert(3 * column + l, 3 * row + k) = matrix.blocks[i](k, l);
    }
  lower.makeCompressed();
  return lower;
}

}  // namespace

struct LinearSystem::Parts {
  LinearSolver kind;
  double tolerance;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factorization;
  bool is_analyzed = false;
  ConjugateGradients gradients;

  bool solve_directly(const BlockMatrix& matrix, bool new_pattern, const Eigen::VectorXd& right, Eigen::VectorXd& x) {
    const Eigen::SparseMatrix<double> lower = lower_triangle(matrix);
    if (new_pattern || !is_analyzed) factorization.analyzePattern(lower);
    is_analyzed = true;
    factorization.factorize(lower);
    if (factorization.info() != Eigen::Success) return false;
    x = factorization.solve(right);
    return true;
  }

  std::int64_t iterate(const BlockMatrix& matrix, const Eigen::VectorXd& right, Eigen::VectorXd& x) {
    is_analyzed = false;
    return gradients.solve(matrix, right, tolerance, x);
  }
};

LinearSystem::LinearSystem(LinearSolver kind, double tolerance) : parts_(std::make_unique<Parts>()) {
  parts_->kind = kind;
  parts_->tolerance = tolerance;
}
LinearSystem::~LinearSystem() = default;
LinearSystem::LinearSystem(LinearSystem&&) noexcept = default;
LinearSystem& LinearSystem::operator=(LinearSystem&&) noexcept = default;

std::optional<std::int64_t> LinearSystem::solve(const BlockMatrix& matrix, bool new_pattern,
                                                const Eigen::VectorXd& right, Eigen::VectorXd& x) {
  const bool directly = parts_->kind == LinearSolver::kDirect ||
                        (parts_->kind == LinearSolver::kBySize && matrix.row_count() <= kMaxDirectVertices);
  if (!directly) return parts_->iterate(matrix, right, x);
  if (!parts_->solve_directly(matrix, new_pattern, right, x)) return {};
  return 0;
}

}  // namespace selvage
