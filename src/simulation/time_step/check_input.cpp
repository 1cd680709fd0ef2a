#include "simulation/time_step/check_input.h"

#include "selvage/core/error.h"
#include "simulation/colliders/prepared_collider.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace selvage {

void check_option(bool is_good, std::string_view name, double value, std::string_view range) {
  if (!is_good) throw Error(name, fmt::format("is {}", value), fmt::format("give a number {}", range));
}

void check_options(const StepOptions& options) {
  check_option(options.time_step > 0 && std::isfinite(options.time_step), "time step", options.time_step, "above 0");
  check_option(options.gravity.allFinite(), "gravity", options.gravity.norm(), "that is finite");
  check_option(options.velocity_damping >= 0, "velocity damping", options.velocity_damping, "that is not negative");
  check_option(options.deformation_damping >= 0, "deformation damping", options.deformation_damping,
               "that is not negative");
  check_option(options.sleep_speed >= 0, "sleep speed", options.sleep_speed, "that is not negative");
  check_option(options.max_speed > 0, "largest speed", options.max_speed, "above 0");
  const auto [static_coefficient, dynamic_coefficient] = options.friction;
  const ContactOptions& contact = options.contact;
  if (contact.guarantee && !(contact.splits() && contact.hold_back && contact.detect_edges))
    throw Error("guarantee", "needs the hybrid mode with edges and hold_back, without interior points",
                "leave these options as they are by default, or give no guarantee");
  check_option(static_coefficient >= 0, "static friction", static_coefficient, "that is not negative");
  check_option(dynamic_coefficient >= 0, "dynamic friction", dynamic_coefficient, "that is not negative");
}

void check_state(const Model& model, const State& state) {
  const auto count = static_cast<std::size_t>(model.mesh.vertex_count());
  if (state.positions.size() != count || state.velocities.size() != count)
    throw Error("state",
                fmt::format("{} positions and {} velocities for {} vertices", state.positions.size(),
                            state.velocities.size(), count),
                "give one of each per vertex");
  if (!state.rest_times.empty() && state.rest_times.size() != model.bodies.size())
    throw Error("state", fmt::format("{} rest times for {} bodies", state.rest_times.size(), model.bodies.size()),
                "give one per body, or none at all");
}

void check_forces(const Model& model, std::span<const Vec3> external_forces) {
  if (!external_forces.empty() && std::ssize(external_forces) != model.mesh.vertex_count())
    throw Error("external forces", fmt::format("{} for {} vertices", external_forces.size(), model.mesh.vertex_count()),
                "give one per vertex, or none at all");
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

}  // namespace selvage
