// Only what Eigen has under the MPL2: its simplicial factorization and conjugate gradients.
#define EIGEN_MPL2_ONLY

#include "simulation/newton/linear_solver.h"

#include "core/parallel.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>

namespace selvage {

class BlockOperator;

}  // namespace selvage

namespace Eigen::internal {

template <>
struct traits<selvage::BlockOperator> : traits<SparseMatrix<double>> {};

}  // namespace Eigen::internal

namespace selvage {

/// A BlockMatrix as Eigen's iterative solvers see it.
class BlockOperator : public Eigen::EigenBase<BlockOperator> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic, IsRowMajor = true };

  explicit BlockOperator(const BlockMatrix& blocks) : matrix(blocks) {}
  Eigen::Index rows() const { return 3 * Eigen::Index{matrix.row_count()}; }
  Eigen::Index cols() const { return rows(); }

  template <typename Right>
  Eigen::Product<BlockOperator, Right, Eigen::AliasFreeProduct> operator*(const Eigen::MatrixBase<Right>& x) const {
    return {*this, x.derived()};
  }

  const BlockMatrix& matrix;
};

namespace {

/// Inverts the blocks of the diagonal.
class BlockJacobi {
 public:
  using StorageIndex = int;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic };

  BlockJacobi() = default;
  BlockJacobi& analyzePattern(const BlockOperator&) { return *this; }
  BlockJacobi& factorize(const BlockOperator& of) { return compute(of); }
  BlockJacobi& compute(const BlockOperator& of) {
    inverses_.resize(of.matrix.row_count());
    parallel_for(of.matrix.row_count(), 1024, [&](std::int64_t row) {
      const auto v = static_cast<Index>(row);
      inverses_[row] = of.matrix.blocks[of.matrix.find(v, v)].inverse();
    });
    return *this;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const {
    Eigen::VectorXd x(right.size());
    parallel_for(std::ssize(inverses_), 1024,
                 [&](std::int64_t row) { x.segment<3>(3 * row) = inverses_[row] * right.segment<3>(3 * row); });
    return x;
  }
  Eigen::ComputationInfo info() const { return Eigen::Success; }

 private:
  std::vector<Eigen::Matrix3d> inverses_;
};

}  // namespace

}  // namespace selvage

namespace Eigen::internal {

template <typename Right>
struct generic_product_impl<selvage::BlockOperator, Right, SparseShape, DenseShape, GemvProduct>
    : generic_product_impl_base<selvage::BlockOperator, Right, generic_product_impl<selvage::BlockOperator, Right>> {
  using Scalar = double;

  template <typename Result>
  static void scaleAndAddTo(Result& result, const selvage::BlockOperator& left, const Right& right,
                            const Scalar& scale) {
    VectorXd product;
    left.matrix.multiply(right, product);
    result += scale * product;
  }
};

}  // namespace Eigen::internal

namespace selvage {

namespace {

/// Of conjugate gradients: what is left then shows in StepStatistics::residual.
constexpr int kMaxIterations = 2000;
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
    const BlockOperator blocks(matrix);
    Eigen::ConjugateGradient<BlockOperator, Eigen::Lower | Eigen::Upper, BlockJacobi> gradients;
    gradients.setTolerance(tolerance);
    gradients.setMaxIterations(kMaxIterations);
    gradients.compute(blocks);
    x = gradients.solve(right);
    return gradients.iterations();
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
