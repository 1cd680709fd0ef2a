#include "selvage/simulation/xpbd.h"

#include "core/parallel.h"
#include "core/timed.h"
#include "selvage/contact/contact_finder.h"
#include "selvage/core/error.h"
#include "simulation/xpbd/material_solver.h"
#include "simulation/xpbd/project_contacts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace selvage {

namespace {

/// Part of a step by which the rounding of times is forgiven.
constexpr double kTimeSlack = 1e-6;

void check_options(const XpbdOptions& options) {
  const auto demand = [](bool good, std::string_view name, double value, std::string_view range) {
    if (!good) throw Error(name, fmt::format("is {}", value), fmt::format("give a number {}", range));
  };
  demand(options.time_step > 0 && std::isfinite(options.time_step), "time step", options.time_step, "above 0");
  demand(options.iterations > 0, "iterations", options.iterations, "of at least 1");
  demand(options.gravity.allFinite(), "gravity", options.gravity.norm(), "that is finite");
  demand(options.velocity_damping >= 0, "velocity damping", options.velocity_damping, "that is not negative");
  demand(options.max_speed > 0, "largest speed", options.max_speed, "above 0");
  demand(options.static_friction >= 0, "static friction", options.static_friction, "that is not negative");
  demand(options.dynamic_friction >= 0, "dynamic friction", options.dynamic_friction, "that is not negative");
}

void check_state(const Model& model, const State& state) {
  const auto count = static_cast<std::size_t>(model.mesh.vertex_count());
  if (!model.external_forces.empty() && model.external_forces.size() != count)
    throw Error("external forces", fmt::format("{} for {} vertices", model.external_forces.size(), count),
                "give one per vertex, or none at all");
  if (state.positions.size() != count || state.velocities.size() != count)
    throw Error("state",
                fmt::format("{} positions and {} velocities for {} vertices", state.positions.size(),
                            state.velocities.size(), count),
                "give one of each per vertex");
}

void check_handles(const Model& model, std::span<const Handle> handles) {
  std::vector<Index> held_by(model.mesh.vertex_count(), kNone);
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const std::string where = fmt::format("handle {}", h);
    check_motion(where, handles[h].motion);
    for (const Index v : handles[h].vertices) {
      if (v < 0 || v >= model.mesh.vertex_count())
        throw Error(where, fmt::format("there is no vertex {}", v),
                    fmt::format("vertices lie in [0, {})", model.mesh.vertex_count()));
      if (std::exchange(held_by[v], static_cast<Index>(h)) != kNone)
        throw Error(where, fmt::format("vertex {} is held twice", v), "hold each vertex once");
    }
  }
}

}  // namespace

struct XpbdSolver::Parts {
  const Model& model;
  XpbdOptions options;
  std::vector<Handle> handles;
  std::vector<std::vector<Vec3>> handle_places;  ///< where the vertices of each were at time 0
  std::vector<PreparedCollider> colliders;
  MaterialSolver material;
  std::optional<ContactFinder> contact_finder;
  std::vector<Vec3> proposed;  ///< positions after the material solve
  std::vector<Contact> contacts;
  std::vector<double> reaches;               ///< see project_contacts()
  std::vector<FrictionState> contact_grips;  ///< (n_contacts)
  std::vector<Vec3> sent;                    ///< (n_vertices) see project_contacts()
  std::vector<ColliderGrip> collider_grips;  ///< (n_vertices x n_colliders)
  ColliderContacts collider_contacts;        ///< of the step
  std::vector<VertexRow> vertices;           ///< as the step moves them
  std::vector<VertexRow> start;              ///< the same at the start of the step, where it is needed
  std::int64_t steps = 0;                    ///< begun by this solver
  StepStatistics statistics;

  Parts(const Model& m, const State& initial, std::vector<Handle> h, std::span<const Collider> c, const XpbdOptions& o)
      : model(m), options(o), handles(std::move(h)), colliders(prepare_colliders(c)), material(m, options.time_step) {
    for (const Handle& handle : handles) {
      std::vector<Vec3>& places = handle_places.emplace_back();
      for (const Index v : handle.vertices) places.push_back(initial.positions[v]);
    }
    vertices.resize(model.mesh.vertex_count());
    sent.resize(vertex_count(), Vec3::Zero());
    collider_grips.resize(vertex_count() * colliders.size());
    if (material.needs_start()) start = vertices;
    reaches = reaches_of(model);
    if (options.contact.mode == DetectionMode::kOff) return;
    std::vector<Index> body_of(vertex_count(), kNone);
    for (Index b = 0; b < std::ssize(model.bodies); ++b)
      std::fill_n(body_of.begin() + model.bodies[b].first_vertex, model.bodies[b].vertex_count, b);
    ContactOptions contact = options.contact;
    // What CCD alone lets go it never finds again.
    contact.wait_for_inverted = contact.mode != DetectionMode::kCcd;
    contact_finder.emplace(model.mesh, model.rest_positions, initial.positions, body_of, contact);
    proposed.resize(vertex_count());
  }

  Index vertex_count() const { return model.mesh.vertex_count(); }

  template <typename Body>
  void for_each_vertex(Body&& body) const {
    parallel_for(vertex_count(), kGrain, [&](std::int64_t v) { body(static_cast<Index>(v)); });
  }

  /// Where vertices go when nothing is in their way.
  void predict(const State& state, double from, double to) {
    const double step = options.time_step, kept = 1 / (1 + step * options.velocity_damping);
    for_each_vertex([&](Index v) {
      const double inverse_mass = model.inverse_masses[v];
      Vec3 velocity = Vec3::Zero();
      if (inverse_mass > 0) {
        Vec3 acceleration = options.gravity;
        if (!model.external_forces.empty()) acceleration += inverse_mass * model.external_forces[v];
        velocity = kept * (state.velocities[v] + step * acceleration);
      }
      place(v, state.positions[v] + step * velocity, inverse_mass);
    });
    for (std::size_t h = 0; h < handles.size(); ++h) {
      if (from + kTimeSlack * step >= handles[h].release_time) continue;
      const RigidTransform transform = handles[h].motion.at(to);
      for (std::size_t i = 0; i < handles[h].vertices.size(); ++i)
        place(handles[h].vertices[i], transform(handle_places[h][i]), 0);
    }
    if (!start.empty())
      for_each_vertex([&](Index v) {
        start[v] = vertices[v];
        for (int i = 0; i < 3; ++i) start[v].position[i] = state.positions[v][i];
      });
  }

  void place(Index v, const Vec3& position, double inverse_mass) {
    vertices[v] = {{position[0], position[1], position[2]}, inverse_mass};
  }

  Vec3 position(Index v) const { return Eigen::Map<const Eigen::Vector3d>(vertices[v].position); }

  /// @throws Error  naming the first vertex that is nowhere
  void check_finite(std::int64_t number) const {
    struct First {
      Index vertex = std::numeric_limits<Index>::max();
      void add(const First& other) { vertex = std::min(vertex, other.vertex); }
    };
    const First first =
        parallel_reduce<First>(vertex_count(), kGrain, [&](std::int64_t begin, std::int64_t end, First& result) {
          for (std::int64_t v = begin; v < end; ++v)
            if (!is_in_range(position(static_cast<Index>(v)))) result.add({static_cast<Index>(v)});
        });
    if (first.vertex == std::numeric_limits<Index>::max()) return;
    throw Error(fmt::format("vertex {}", first.vertex),
                fmt::format("its position stops being finite in step {}", number),
                "take a smaller time step, softer materials or slower handles");
  }

  /// Whether vertices may be inside colliders that nothing had to do with before: at first, and when let go. Later
  /// those are that two colliders press from one into the other.
  bool may_start_inside(const State& state, double from) const {
    const double step = options.time_step;
    return state.steps == 0 || std::any_of(handles.begin(), handles.end(), [&](const Handle& handle) {
             const double since = from + kTimeSlack * step - handle.release_time;
             return since >= 0 && since < step;
           });
  }

  /// How far colliders have moved a vertex for no other reason than that it started the step inside of them. That gives
  /// it no speed: a body that starts half in the floor would fly off with its depth a step.
  Vec3 lift_of(Index v) const {
    Vec3 lift = Vec3::Zero();
    if (collider_contacts.buried == 0) return lift;
    for (std::size_t o = 0; o < colliders.size(); ++o) {
      const ColliderGrip& grip = collider_grips[v * colliders.size() + o];
      if (grip.step == steps) lift += grip.lift();
    }
    return lift;
  }

  void finish(State& state) const {
    for_each_vertex([&](Index v) {
      Vec3 velocity = (position(v) - state.positions[v] - lift_of(v)) / options.time_step;
      const double speed = velocity.norm();
      if (speed > options.max_speed) velocity *= options.max_speed / speed;
      state.velocities[v] = velocity;
      state.positions[v] = position(v);
    });
  }

  void solve_material(int first, int last) {
    timed(statistics.seconds_material, [&] { material.solve(vertices, start, first, last); });
    statistics.constraints += material.constraint_count() * (last - first);
  }

  void find_contacts() {
    if (!contact_finder) return;
    for_each_vertex([&](Index v) { proposed[v] = position(v); });
    contact_finder->find_contacts(proposed, contacts);
    statistics.contact = contact_finder->statistics();
  }

  void project(const State& state, double from, double to) {
    timed(statistics.seconds_projection, [&] {
      const Step step{steps, from, to, state.positions, state.velocities};
      project_contacts(contacts, step, reaches, {options.static_friction, options.dynamic_friction}, contact_grips,
                       sent, vertices);
      const auto reach = may_start_inside(state, from) ? std::span<const double>(reaches) : std::span<const double>();
      collider_contacts.add(project_colliders(colliders, step, reach, sent, collider_grips, vertices));
      statistics.collider_contacts = collider_contacts.count;
    });
  }

  /// Contacts are found where the first half of the iterations leads, and projected between the others. Projected only
  /// once, after the last, they would move a boundary whose inside stays behind: what is pressed hard turns inside out.
  void step(State& state) {
    const double from = static_cast<double>(state.steps) * options.time_step;
    const double to = static_cast<double>(state.steps + 1) * options.time_step;
    ++steps;
    if (contact_finder) contact_finder->begin_step(state.positions);
    predict(state, from, to);
    const int free_iterations = std::max(options.iterations / 2, 1);
    solve_material(0, free_iterations);
    check_finite(state.steps + 1);
    for (const Contact& contact : contacts)
      for (int i = 0; i < contact.count; ++i) sent[contact.vertices[i]].setZero();
    find_contacts();
    contact_grips.assign(contacts.size(), {});
    collider_contacts = {};
    project(state, from, to);
    for (int iteration = free_iterations; iteration < options.iterations; ++iteration) {
      solve_material(iteration, iteration + 1);
      project(state, from, to);
    }
    check_finite(state.steps + 1);
    finish(state);
    state.time = to;
    ++state.steps;
  }
};

XpbdSolver::XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles,
                       std::vector<Collider> colliders, const XpbdOptions& options) {
  check_options(options);
  check_state(model, initial);
  check_handles(model, handles);
  parts_ = std::make_unique<Parts>(model, initial, std::move(handles), colliders, options);
}
XpbdSolver::~XpbdSolver() = default;
XpbdSolver::XpbdSolver(XpbdSolver&&) noexcept = default;
XpbdSolver& XpbdSolver::operator=(XpbdSolver&&) noexcept = default;

void XpbdSolver::step(State& state) {
  check_state(parts_->model, state);
  parts_->statistics = {};
  timed(parts_->statistics.seconds, [&] { parts_->step(state); });
}

const StepStatistics& XpbdSolver::statistics() const {
  return parts_->statistics;
}

}  // namespace selvage
