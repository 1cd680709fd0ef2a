#include "core/parallel.h"
#include "core/timed.h"
#include "selvage/simulation/vbd.h"
#include "simulation/implicit/implicit_step.h"
#include "simulation/time_step/check_input.h"
#include "simulation/vbd/vertex_colours.h"
#include "simulation/vbd/vertex_stars.h"

#include <Eigen/Cholesky>

namespace selvage {

namespace {

/// Vertices that a task moves, and those whose sums are kept at a time.
constexpr std::int64_t kSweepGrain = 64;
constexpr Index kSumsAtOnce = 32;

/// Part of the sweeps that are made again where contacts have been added to a minimum that is nearly found.
constexpr int kLaterPart = 4;

/// Times that a step of a vertex is halved.
constexpr int kHalvings = 8;
/// Part of an energy that is rounding.
constexpr double kEnergyRounding = 1e-13;

}  // namespace

struct VbdSolver::Parts {
  VbdOptions options;
  ImplicitStep implicit;
  VertexColours colours;
  VertexStars stars;
  std::vector<Vec3> moved;  ///< of the vertices of a colour

  Parts(const Model& model, const State& initial, std::vector<Handle> handles, std::span<const Collider> colliders,
        const VbdOptions& o)
      : options(o),
        implicit(model, initial, std::move(handles), colliders, options),
        colours(colour_vertices(model)),
        stars(model, colours, implicit.potential().cloth()) {
    check_option(options.iterations > 0, "iterations", options.iterations, "of at least 1");
    check_option(options.residual >= 0, "residual", options.residual, "that is not negative");
    moved.resize(colours.vertices.size());
  }

  /// Results go to a buffer first: contacts between vertices of one colour see where these were.
  void sweep(const IncrementalPotential& potential, std::vector<Vec3>& x) {
    for (Index c = 0; c < colours.colour_count(); ++c) {
      const Index first = colours.first[c], count = colours.first[c + 1] - first;
      parallel_ranges(count, kSweepGrain, [&](std::int64_t begin, std::int64_t end) {
        for (; begin < end; begin += kSumsAtOnce)
          move(potential, x, static_cast<Index>(first + begin),
               static_cast<Index>(first + std::min<std::int64_t>(begin + kSumsAtOnce, end)));
      });
      parallel_for(count, 16 * kSweepGrain, [&](std::int64_t i) {
        const Index v = colours.vertices[first + i];
        x[v] = moved[first + i];
        stars.place(v, x[v]);
      });
    }
  }

  /// Finds where the vertices at some places of the order of colours move.
  void move(const IncrementalPotential& potential, std::span<const Vec3> x, Index first, Index last) {
    StarSums sums[kSumsAtOnce];
    VertexStars::Derivatives derivatives;
    stars.sum(first, last, sums);
    for (Index i = first; i < last; ++i) {
      const Index v = colours.vertices[i];
      moved[i] = x[v];
      if (!potential.is_free(v)) continue;
      stars.differentiate(potential, x, i, sums[i - first], derivatives);
      const Vec3 step = derivatives.all.hessian.llt().solve(derivatives.all.gradient);
      if (step.allFinite()) moved[i] -= find_share(x, i, derivatives, step) * step;
    }
  }

  /// The part of a vertex's step, which goes against `step`, with which the energy falls: cloth that is pressed is not
  /// convex in a vertex, and a contact may begin on the way.
  double find_share(std::span<const Vec3> x, Index i, const VertexStars::Derivatives& derivatives,
                    const Vec3& step) const {
    if (stars.cloth().is_empty(i) && derivatives.contacts.empty()) return 1;
    const VertexDerivatives& quadratic = derivatives.quadratic;
    const double before = derivatives.energy(), slope = quadratic.gradient.dot(step),
                 curvature = step.dot(quadratic.hessian * step);
    double share = 1;
    for (int k = 0; k < kHalvings; ++k, share /= 2) {
      const double change =
          stars.energy(x, i, -share * step, derivatives) - before - share * slope + share * share / 2 * curvature;
      if (change <= kEnergyRounding * before) break;
    }
    return share;
  }

  void minimize(IncrementalPotential& potential, bool is_guess, std::vector<Vec3>& x) {
    StepStatistics& statistics = implicit.statistics();
    stars.place(x);
    if (is_guess) stars.begin();
    stars.renew_contacts(potential);
    const int count = is_guess ? options.iterations : (options.iterations + kLaterPart - 1) / kLaterPart;
    for (int iteration = 0; iteration < count; ++iteration) {
      potential.renew_friction(x, is_guess && iteration == 0);
      sweep(potential, x);
      ++statistics.newton_steps;
      if (options.residual > 0 && residual_of(potential, x) <= options.residual) break;
    }
    statistics.residual = residual_of(potential, x);
  }

  void step(State& state, std::span<const Vec3> external_forces) {
    implicit.step(state, external_forces, [&](IncrementalPotential& potential, bool is_guess, std::vector<Vec3>& x) {
      minimize(potential, is_guess, x);
    });
  }
};

VbdSolver::VbdSolver(const Model& model, const State& initial, std::vector<Handle> handles,
                     std::vector<Collider> colliders, const VbdOptions& options)
    : parts_(std::make_unique<Parts>(model, initial, std::move(handles), colliders, options)) {}
VbdSolver::~VbdSolver() = default;
VbdSolver::VbdSolver(VbdSolver&&) noexcept = default;
VbdSolver& VbdSolver::operator=(VbdSolver&&) noexcept = default;

void VbdSolver::step(State& state, std::span<const Vec3> external_forces) {
  double seconds = 0;
  timed(seconds, [&] { parts_->step(state, external_forces); });
  parts_->implicit.statistics().seconds = seconds;
}

std::span<const Contact> VbdSolver::contacts() const {
  return parts_->implicit.time_step().contacts();
}

const StepStatistics& VbdSolver::statistics() const {
  return parts_->implicit.time_step().statistics();
}

double VbdSolver::objective() const {
  return parts_->implicit.objective();
}

}  // namespace selvage
