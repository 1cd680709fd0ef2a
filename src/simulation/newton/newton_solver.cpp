#include "core/timed.h"
#include "selvage/simulation/newton.h"
#include "simulation/implicit/implicit_step.h"
#include "simulation/newton/minimize.h"
#include "simulation/time_step/check_input.h"

#include <algorithm>

namespace selvage {

namespace {

/// Part of the mean edge that counts as near the solution.
constexpr double kNear = 0.1;

}  // namespace

struct NewtonSolver::Parts {
  NewtonOptions options;
  ImplicitStep implicit;
  LinearSystem system;
  BlockMatrix matrix;

  Parts(const Model& model, const State& initial, std::vector<Handle> handles, std::span<const Collider> colliders,
        const NewtonOptions& o)
      : options(o),
        implicit(model, initial, std::move(handles), colliders, options),
        system(options.linear_solver, options.linear_tolerance) {
    check_option(options.newton_steps > 0, "newton steps", options.newton_steps, "of at least 1");
    check_option(options.tolerance >= 0, "tolerance", options.tolerance, "that is not negative");
    check_option(options.linear_tolerance > 0 && options.linear_tolerance < 1, "linear tolerance",
                 options.linear_tolerance, "above 0 and below 1");
  }

  double least_length() const {
    const double by_gravity = options.gravity.norm() * options.time_step * options.time_step;
    return by_gravity > 0 ? std::min(by_gravity, implicit.mean_edge()) : implicit.mean_edge();
  }

  void step(State& state, std::span<const Vec3> external_forces) {
    implicit.step(state, external_forces, [&](IncrementalPotential& potential, bool, std::vector<Vec3>& x) {
      const NewtonLimits limits{options.newton_steps, options.tolerance * least_length(), kNear * implicit.mean_edge()};
      const NewtonReport report = minimize(potential, system, limits, matrix, x);
      StepStatistics& statistics = implicit.statistics();
      statistics.newton_steps += report.steps;
      statistics.linear_iterations += report.linear_iterations;
      statistics.residual = residual_of(potential, x);
    });
  }
};

NewtonSolver::NewtonSolver(const Model& model, const State& initial, std::vector<Handle> handles,
                           std::vector<Collider> colliders, const NewtonOptions& options)
    : parts_(std::make_unique<Parts>(model, initial, std::move(handles), colliders, options)) {}
NewtonSolver::~NewtonSolver() = default;
NewtonSolver::NewtonSolver(NewtonSolver&&) noexcept = default;
NewtonSolver& NewtonSolver::operator=(NewtonSolver&&) noexcept = default;

void NewtonSolver::step(State& state, std::span<const Vec3> external_forces) {
  double seconds = 0;
  timed(seconds, [&] { parts_->step(state, external_forces); });
  parts_->implicit.statistics().seconds = seconds;
}

std::span<const Contact> NewtonSolver::contacts() const {
  return parts_->implicit.time_step().contacts();
}

const StepStatistics& NewtonSolver::statistics() const {
  return parts_->implicit.time_step().statistics();
}

double NewtonSolver::objective() const {
  return parts_->implicit.objective();
}

}  // namespace selvage
