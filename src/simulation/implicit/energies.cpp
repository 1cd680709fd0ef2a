#include "simulation/implicit/energies.h"

#include "elasticity/edge_spring.h"
#include "simulation/elements/ordered_sum.h"

#include <algorithm>
#include <limits>

namespace selvage {

namespace {

bool has_springs(const Body& body) {
  return body.material.kind == MaterialKind::kMassSpring && body.material.edge_compliance > 0;
}

}  // namespace

// Over a step without end nothing is damped.
EnergyMeasure::EnergyMeasure(const Model& model)
    : model_(model), cloth_(model, std::numeric_limits<double>::infinity()) {
  std::vector<Index> body_of(model.mesh.vertex_count(), kNone);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    if (has_springs(body)) std::fill_n(body_of.begin() + body.first_vertex, body.vertex_count, static_cast<Index>(b));
  }
  if (std::none_of(model.bodies.begin(), model.bodies.end(), has_springs)) return;
  for (const VertexTuple<2>& edge : model.mesh.edges())
    if (body_of[edge[0]] != kNone) springs_.push_back({edge, body_of[edge[0]]});
}

double EnergyMeasure::spring_energy(const Spring& spring, std::span<const Vec3> x) const {
  const StencilPositions<2> rest = gather(spring.vertices, model_.rest_positions);
  return EdgeSpring{1 / model_.bodies[spring.body].material.edge_compliance, (rest.col(1) - rest.col(0)).norm()}.energy(
      gather(spring.vertices, x));
}

Energies EnergyMeasure::measure(const State& state, const Vec3& gravity, const SolidMeasure& solids) const {
  const std::span<const Vec3> x = state.positions;
  Energies energies;
  const auto over_mass = [&](std::int64_t v, double value) {
    return model_.inverse_masses[v] > 0 ? value / model_.inverse_masses[v] : 0;
  };
  energies.kinetic =
      ordered_sum(std::ssize(x), [&](std::int64_t v) { return over_mass(v, 0.5 * state.velocities[v].squaredNorm()); });
  energies.gravity = ordered_sum(std::ssize(x), [&](std::int64_t v) { return over_mass(v, -gravity.dot(x[v])); });
  energies.elastic =
      solids.energy + ordered_sum(std::ssize(springs_), [&](std::int64_t s) { return spring_energy(springs_[s], x); });
  energies.elastic +=
      ordered_sum(cloth_.count(), [&](std::int64_t t) { return cloth_.energy(static_cast<Index>(t), x); });
  return energies;
}

}  // namespace selvage
