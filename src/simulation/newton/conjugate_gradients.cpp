#include "simulation/newton/conjugate_gradients.h"

#include "core/parallel.h"
#include "simulation/newton/product_kernel.h"

#include <Eigen/LU>

#include <cmath>
#include <numeric>

namespace selvage {

namespace {

constexpr std::int64_t kMaxIterations = 2000;
/// Times that the residual is solved for.
constexpr int kMaxCorrections = 8;
/// What one correction leaves at least, by what it begins with: single precision is not much better.
constexpr double kLeastPart = 1e-4;
/// Rows whose sums are added up by themselves, in an order that does not depend on threads.
constexpr std::int64_t kRun = 256;

/// Calls body(run, first, last) on the runs of rows.
template <typename Body>
void for_runs(std::int64_t rows, const Body& body) {
  parallel_for((rows + kRun - 1) / kRun, 1,
               [&](std::int64_t run) { body(run, run * kRun, std::min((run + 1) * kRun, rows)); });
}

double total(const std::vector<double>& sums) {
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

}  // namespace

void ConjugateGradients::take_over(const BlockMatrix& matrix) {
  const std::int64_t rows = matrix.row_count();
  blocks_.resize(9 * matrix.blocks.size() + 1);
  blocks_.back() = 0;
  inverses_.resize(rows);
  sums_.resize((rows + kRun - 1) / kRun);
  other_sums_.resize(sums_.size());
  for (Eigen::VectorXd* vector : {&residual_, &scaled_, &direction_, &product_}) vector->resize(3 * rows);
  for_runs(rows, [&](std::int64_t, std::int64_t first, std::int64_t last) {
    for (std::int64_t i = matrix.first[first]; i < matrix.first[last]; ++i)
      Eigen::Map<Eigen::Matrix3f>(blocks_.data() + 9 * i) = matrix.blocks[i].cast<float>();
    for (std::int64_t row = first; row < last; ++row) {
      const auto v = static_cast<Index>(row);
      inverses_[row] = matrix.blocks[matrix.find(v, v)].inverse();
    }
  });
}

/// Product of the matrix with the direction. Returns that with the direction.
double ConjugateGradients::multiply(const BlockMatrix& matrix) {
  const ProductTask task{matrix.first.data(), matrix.columns.data(), blocks_.data(), direction_.data(),
                         product_.data()};
  for_runs(matrix.row_count(), [&](std::int64_t run, std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(multiply_rows, task, first, last, sums_[run]);
  });
  return total(sums_);
}

/// Adds to x what solves for the residual, down to a length of `least`.
std::int64_t ConjugateGradients::correct(const BlockMatrix& matrix, double least, std::int64_t most,
                                         Eigen::VectorXd& x) {
  const std::int64_t rows = matrix.row_count();
  std::int64_t iterations = 0;
  double step = 0, before = 0;
  for (;;) {
    for_runs(rows, [&](std::int64_t run, std::int64_t first, std::int64_t last) {
      double squared = 0, scaled = 0;
      for (std::int64_t row = first; row < last; ++row) {
        auto r = residual_.segment<3>(3 * row), z = scaled_.segment<3>(3 * row);
        if (iterations > 0) {
          x.segment<3>(3 * row) += step * direction_.segment<3>(3 * row);
          r -= step * product_.segment<3>(3 * row);
        }
        z = inverses_[row] * r;
        squared += r.squaredNorm();
        scaled += r.dot(z);
      }
      sums_[run] = squared;
      other_sums_[run] = scaled;
    });
    const double length = std::sqrt(total(sums_)), now = total(other_sums_);
    if (!(length > least) || iterations >= most) return iterations;
    const double keep = iterations > 0 ? now / before : 0;
    for_runs(rows, [&](std::int64_t, std::int64_t first, std::int64_t last) {
      auto p = direction_.segment(3 * first, 3 * (last - first));
      const auto z = scaled_.segment(3 * first, 3 * (last - first));
      if (iterations > 0)
        p = z + keep * p;
      else
        p = z;
    });
    before = now;
    const double curvature = multiply(matrix);
    if (!(curvature > 0)) return iterations;
    step = now / curvature;
    ++iterations;
  }
}

std::int64_t ConjugateGradients::solve(const BlockMatrix& matrix, const Eigen::VectorXd& right, double tolerance,
                                       Eigen::VectorXd& x) {
  take_over(matrix);
  x.setZero(right.size());
  residual_ = right;
  const double least = tolerance * right.norm();
  double length = right.norm();
  std::int64_t iterations = 0;
  for (int i = 0; i < kMaxCorrections && length > least && iterations < kMaxIterations; ++i) {
    iterations += correct(matrix, std::max(least, kLeastPart * length), kMaxIterations - iterations, x);
    matrix.multiply(x, product_);
    residual_ = right - product_;
    const double was = length;
    length = residual_.norm();
    if (!(length < 0.5 * was)) break;
  }
  return iterations;
}

}  // namespace selvage
