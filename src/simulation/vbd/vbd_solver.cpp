#include "core/parallel.h"
#include "core/timed.h"
#include "selvage/simulation/vbd.h"
#include "simulation/implicit/implicit_step.h"
#include "simulation/time_step/check_input.h"
#include "simulation/vbd/vertex_colours.h"
#include "simulation/vbd/vertex_stars.h"

#include <cmath>

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

/// Of a x = b, by Cholesky, inline: a sweep does little else. Not finite where a is not positive definite.
Vec3 solve_positive(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  const double l00 = std::sqrt(a(0, 0)), l10 = a(1, 0) / l00, l20 = a(2, 0) / l00;
  const double l11 = std::sqrt(a(1, 1) - l10 * l10), l21 = (a(2, 1) - l20 * l10) / l11;
  const double l22 = std::sqrt(a(2, 2) - (l20 * l20 + l21 * l21));
  const double y0 = b[0] / l00, y1 = (b[1] - l10 * y0) / l11, y2 = (b[2] - (l20 * y0 + l21 * y1)) / l22;
  const double x2 = y2 / l22, x1 = (y1 - l21 * x2) / l11;
  return {(y0 - (l10 * x1 + l20 * x2)) / l00, x1, x2};
}

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
      const Vec3 step = solve_positive(derivatives.all.hessian, derivatives.all.gradient);
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
