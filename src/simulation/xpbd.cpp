#include "selvage/simulation/xpbd.h"

#include "selvage/core/error.h"
#include "selvage/core/parallel.h"
#include "simulation/material_solver.h"

#include <fmt/format.h>

#include <chrono>

namespace selvage {

namespace {

constexpr std::int64_t kGrain = 4096;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

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

void check_motion(const std::string& where, const Motion& motion) {
  if (!(motion.axis.norm() > 0) || !motion.axis.allFinite() || !motion.centre.allFinite())
    throw Error(where, "its axis or centre is not finite, or the axis is 0");
  for (std::size_t i = 0; i < motion.keyframes.size(); ++i) {
    const Keyframe& keyframe = motion.keyframes[i];
    if (!std::isfinite(keyframe.time) || !keyframe.translation.allFinite() || !std::isfinite(keyframe.angle))
      throw Error(where, fmt::format("key-frame {} is not finite", i));
    if (i > 0 && !(motion.keyframes[i - 1].time < keyframe.time))
      throw Error(where, fmt::format("key-frame {} is not later than the one before", i));
  }
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
  MaterialSolver material;
  std::vector<VertexRow> vertices;  ///< as the step moves them, followed by the solver's stand-ins
  std::vector<VertexRow> start;     ///< the same at the start of the step, where it is needed
  StepStatistics statistics;

  Parts(const Model& m, const State& initial, std::vector<Handle> h, XpbdOptions o)
      : model(m), options(std::move(o)), handles(std::move(h)), material(m, options.time_step) {
    for (const Handle& handle : handles) {
      std::vector<Vec3>& places = handle_places.emplace_back();
      for (const Index v : handle.vertices) places.push_back(initial.positions[v]);
    }
    vertices.resize(model.mesh.vertex_count());
    vertices.insert(vertices.end(), material.stand_ins().begin(), material.stand_ins().end());
    if (material.needs_start()) start = vertices;
  }

  Index vertex_count() const { return model.mesh.vertex_count(); }

  template <typename Body>
  void for_each_vertex(Body&& body) const {
    parallel_for(vertex_count(), kGrain, [&](std::int64_t v) { body(static_cast<Index>(v)); });
  }

  /// Where vertices go when nothing is in their way.
  void predict(const State& state, double end) {
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
      if (end >= handles[h].release_time) continue;
      const RigidTransform transform = handles[h].motion.at(end);
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
            if (!position(static_cast<Index>(v)).allFinite()) result.add({static_cast<Index>(v)});
        });
    if (first.vertex == std::numeric_limits<Index>::max()) return;
    throw Error(fmt::format("vertex {}", first.vertex),
                fmt::format("its position stops being finite in step {}", number),
                "take a smaller time step, softer materials or slower handles");
  }

  void finish(State& state) const {
    for_each_vertex([&](Index v) {
      Vec3 velocity = (position(v) - state.positions[v]) / options.time_step;
      const double speed = velocity.norm();
      if (speed > options.max_speed) velocity *= options.max_speed / speed;
      state.velocities[v] = velocity;
      state.positions[v] = position(v);
    });
  }

  void step(State& state) {
    const auto begin = std::chrono::steady_clock::now();
    statistics = {};
    const double end = static_cast<double>(state.steps + 1) * options.time_step;
    predict(state, end);
    const auto solving = std::chrono::steady_clock::now();
    material.solve(vertices, start, options.iterations);
    statistics.seconds_material = seconds_since(solving);
    statistics.constraints = material.constraint_count() * options.iterations;
    check_finite(state.steps + 1);
    finish(state);
    state.time = end;
    ++state.steps;
    statistics.seconds = seconds_since(begin);
  }
};

XpbdSolver::XpbdSolver(const Model& model, const State& initial, std::vector<Handle> handles,
                       std::vector<Collider> colliders, XpbdOptions options) {
  check_options(options);
  check_handles(model, handles);
  (void)colliders;
  parts_ = std::make_unique<Parts>(model, initial, std::move(handles), std::move(options));
}
XpbdSolver::~XpbdSolver() = default;
XpbdSolver::XpbdSolver(XpbdSolver&&) noexcept = default;
XpbdSolver& XpbdSolver::operator=(XpbdSolver&&) noexcept = default;

void XpbdSolver::step(State& state) {
  parts_->step(state);
}

const StepStatistics& XpbdSolver::statistics() const {
  return parts_->statistics;
}

}  // namespace selvage
