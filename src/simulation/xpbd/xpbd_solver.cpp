#include "core/timed.h"
#include "selvage/simulation/xpbd.h"
#include "simulation/time_step/check_input.h"
#include "simulation/time_step/time_step.h"
#include "simulation/xpbd/cloth_solver.h"
#include "simulation/xpbd/material_solver.h"
#include "simulation/xpbd/project_contacts.h"

#include <algorithm>

namespace selvage {

namespace {

/// Rounds in which contacts that the projection of others makes are projected too, before vertices are held back.
constexpr int kMissedRounds = 3;

}  // namespace

struct XpbdSolver::Impl {
  XpbdOptions options;
  TimeStep time_step;
  MaterialSolver material;
  ClothSolver cloth;
  std::vector<StepVertex> start;           ///< vertices at the start of the step, where the material needs them
  std::vector<ContactFriction> frictions;  ///< (n_contacts)
  UserConstraint constraint;
  std::vector<StepVertex> before_constraint;

  Impl(const Model& model, const State& initial, std::vector<Handle> handles, std::span<const Collider> colliders,
       const XpbdOptions& o)
      : options(o),
        time_step(model, initial, std::move(handles), colliders, options),
        material(model, options.time_step),
        cloth(model, options.time_step) {
    check_option(options.iterations > 0, "iterations", options.iterations, "of at least 1");
    if (material.needs_start() || cloth.needs_start()) start.resize(model.mesh.vertex_count());
  }

  StepStatistics& statistics() { return time_step.statistics(); }

  void keep_start(const State& state) {
    for (std::size_t v = 0; v < start.size(); ++v) {
      const Vec3& p = state.positions[v];
      start[v] = {{p[0], p[1], p[2]}, time_step.vertices()[v].inverse_mass};
    }
  }

  /// Iterations from `first` to before `last`, without contacts in between.
  void iterate(int first, int last) {
    if (!constraint) return solve_material(first, last);
    const std::span<StepVertex> all = time_step.vertices();
    const StepVertices vertices(all.data()->position, static_cast<Index>(all.size()));
    for (int iteration = first; iteration < last; ++iteration) {
      solve_material(iteration, iteration + 1);
      before_constraint.assign(all.begin(), all.end());
      constraint(vertices, iteration);
      for (std::size_t v = 0; v < all.size(); ++v)
        if (position(all[v]) != position(before_constraint[v])) time_step.hold(static_cast<Index>(v));
    }
  }

  void solve_material(int first, int last) {
    timed(statistics().seconds_material, [&] {
      material.solve(time_step.vertices(), start, first, last);
      for (int i = first; i < last && cloth.constraint_count() > 0; ++i) cloth.solve(time_step.vertices(), start, i);
    });
    statistics().constraints += (material.constraint_count() + cloth.constraint_count()) * (last - first);
  }

  void project() {
    timed(statistics().seconds_projection, [&] {
      for (std::size_t i = frictions.size(); i < time_step.contacts().size(); ++i)
        frictions.push_back({time_step.friction_of(time_step.contacts()[i])});
      project_contacts(time_step.contacts(), time_step.step(), time_step.max_corrections(), time_step.supports(),
                       frictions, time_step.ejected(), time_step.contact_vertices());
      time_step.project_colliders();
    });
  }

  /// Contacts are found where the first half of the iterations leads, and projected between the others. Projected only
  /// once, after the last, they would move the boundary alone, and elements under pressure would be inverted.
  void step(State& state, std::span<const Vec3> external_forces) {
    if (time_step.skip_asleep(state, external_forces, static_cast<bool>(constraint))) return;
    time_step.begin(state, external_forces);
    if (options.contact.splits()) material.turn_back(time_step.unguarded_vertices());
    keep_start(state);
    const int free_iterations = std::max(options.iterations / 2, 1);
    iterate(0, free_iterations);
    time_step.find_contacts();
    frictions.clear();
    project();
    for (int iteration = free_iterations; iteration < options.iterations; ++iteration) {
      iterate(iteration, iteration + 1);
      project();
    }
    for (int round = 0; round < kMissedRounds && time_step.find_missed_contacts(); ++round) project();
    time_step.finish(state);
  }
};

XpbdSolver::XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles,
                       std::vector<Collider> colliders, const XpbdOptions& options)
    : impl_(std::make_unique<Impl>(model, initial, std::move(handles), colliders, options)) {}
XpbdSolver::~XpbdSolver() = default;
XpbdSolver::XpbdSolver(XpbdSolver&&) noexcept = default;
XpbdSolver& XpbdSolver::operator=(XpbdSolver&&) noexcept = default;

void XpbdSolver::set_constraint(UserConstraint constraint) {
  impl_->constraint = std::move(constraint);
}

void XpbdSolver::step(State& state, std::span<const Vec3> external_forces) {
  double seconds = 0;
  timed(seconds, [&] { impl_->step(state, external_forces); });
  impl_->statistics().seconds = seconds;
}

std::span<const Contact> XpbdSolver::contacts() const {
  return impl_->time_step.contacts();
}

const StepStatistics& XpbdSolver::statistics() const {
  return impl_->time_step.statistics();
}

}  // namespace selvage
