#include "simulation/newton/minimize.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr double kSufficient = 1e-4;
constexpr int kMaxHalvings = 30;
/// Newton steps in which friction follows the normal forces; then it is fixed, so that one function is minimised.
constexpr int kFrictionSteps = 3;
/// Part of an energy that is rounding.
constexpr double kObjectiveRounding = 1e-13;

double largest_move(const Eigen::VectorXd& step) {
  double squared = 0;
  for (Eigen::Index i = 0; i < step.size(); i += 3) squared = std::max(squared, step.segment<3>(i).squaredNorm());
  return std::sqrt(squared);
}

void move(std::span<const Vec3> from, const Eigen::VectorXd& step, double share, std::vector<Vec3>& to) {
  for (std::size_t v = 0; v < from.size(); ++v)
    to[v] = from[v] + share * step.segment<3>(3 * static_cast<Eigen::Index>(v));
}

/// Where the step leads, halved until the energy falls as the slope promises. Returns the share that is taken.
double search(const IncrementalPotential& potential, std::span<const Vec3> x, const Eigen::VectorXd& step, double slope,
              std::vector<Vec3>& next) {
  const double before = potential.energy(x);
  double share = 1;
  for (int i = 0; i <= kMaxHalvings; ++i, share /= 2) {
    move(x, step, share, next);
    const double after = potential.energy(next);
    if (after <= before + kSufficient * share * slope) break;
    if (-share * slope <= kObjectiveRounding * std::abs(before) && std::isfinite(after)) break;
  }
  return share;
}

}  // namespace

NewtonReport minimize(IncrementalPotential& potential, LinearSystem& system, const NewtonLimits& limits,
                      BlockMatrix& matrix, std::vector<Vec3>& x) {
  NewtonReport report;
  Eigen::VectorXd gradient, step;
  std::vector<Vec3> next(x.size());
  const auto solve = [&](bool exact) {
    const bool new_pattern = potential.assemble(x, exact, gradient, matrix);
    const std::optional<std::int64_t> iterations = system.solve(matrix, new_pattern, -gradient, step);
    report.linear_iterations += iterations.value_or(0);
    return iterations && step.allFinite() && gradient.dot(step) < 0;
  };
  bool is_near = false;
  while (report.steps < limits.steps && !report.is_done) {
    if (report.steps < kFrictionSteps) potential.renew_friction(x, report.steps == 0);
    if (!(is_near && solve(true)) && !solve(false)) {
      report.is_done = gradient.isZero(0);
      break;
    }
    ++report.steps;
    const double share = search(potential, x, step, gradient.dot(step), next), longest = share * largest_move(step);
    x.swap(next);
    is_near = share == 1 && longest <= limits.near_move;
    report.is_done = longest <= limits.least_move;
  }
  return report;
}

}  // namespace selvage
