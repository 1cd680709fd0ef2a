#include "selvage/simulation/model.h"

#include "selvage/core/error.h"
#include "selvage/geometry/predicates.h"

#include <fmt/format.h>

#include <limits>

namespace selvage {

bool is_in_range(const Vec3& position) {
  return (position.array().abs() <= std::numeric_limits<float>::max()).all();
}

namespace {

void check_size(std::string_view what, std::size_t size, Index vertex_count) {
  if (size != static_cast<std::size_t>(vertex_count))
    throw Error(what, fmt::format("{} entries for {} vertices", size, vertex_count), "give one per vertex");
}

void check_finite(std::span<const Vec3> positions) {
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (!is_in_range(positions[v]))
      throw Error(fmt::format("vertex {}", v), "its position is not finite, or not in single precision",
                  "keep coordinates below 3e38");
}

void check_bodies(const Model& model) {
  Index next = 0;
  for (const Body& body : model.bodies) {
    if (body.first_element != next || body.element_count <= 0 || body.element_count > model.mesh.element_count() - next)
      throw Error(fmt::format("body '{}'", body.name),
                  fmt::format("its elements do not start at {}, or there are none", next),
                  "let each body have the elements after those of the body before");
    next += body.element_count;
    for (Index e = body.first_element; e < next; ++e)
      for (const Index v : model.mesh.elements()[e])
        if (v < body.first_vertex || v - body.first_vertex >= body.vertex_count)
          throw Error(fmt::format("element {}", e), fmt::format("vertex {} is not of its body '{}'", v, body.name));
    check_material(fmt::format("body '{}'", body.name), body.material);
  }
  if (next != model.mesh.element_count())
    throw Error(fmt::format("element {}", next), "is of no body", "let bodies cover all elements");
}

}  // namespace

Model make_model(TetMesh mesh, std::vector<Vec3> rest_positions, std::vector<Body> bodies) {
  Model model{.mesh = std::move(mesh),
              .rest_positions = std::move(rest_positions),
              .bodies = std::move(bodies),
              .inverse_masses = {}};
  check_size("rest positions", model.rest_positions.size(), model.mesh.vertex_count());
  check_finite(model.rest_positions);
  check_bodies(model);
  std::vector<double> masses(model.mesh.vertex_count(), 0.0);
  for (const Body& body : model.bodies)
    for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
      std::array<Vec3, 4> corners;
      for (int k = 0; k < 4; ++k) corners[k] = model.rest_positions[model.mesh.elements()[e][k]];
      if (orientation(corners) <= 0)
        throw Error(fmt::format("element {}", e), "is flat or inverted at rest", "give a rest pose that is neither");
      const double volume = (corners[1] - corners[0]).dot((corners[2] - corners[0]).cross(corners[3] - corners[0])) / 6;
      for (const Index v : model.mesh.elements()[e]) masses[v] += body.material.density * volume / 4;
    }
  model.inverse_masses.resize(masses.size());
  for (std::size_t v = 0; v < masses.size(); ++v) model.inverse_masses[v] = masses[v] > 0 ? 1 / masses[v] : 0;
  return model;
}

State make_state(const Model& model, std::vector<Vec3> positions) {
  check_size("positions", positions.size(), model.mesh.vertex_count());
  check_finite(positions);
  State state{std::move(positions), std::vector<Vec3>(model.mesh.vertex_count(), Vec3::Zero())};
  for (const Body& body : model.bodies)
    for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
      state.velocities[v] = body.initial_velocity;
  return state;
}

}  // namespace selvage
