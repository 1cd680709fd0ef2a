#include "scene/frame_measures.h"

#include "scene/float_rounding.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

double fastest_of(const State& state) {
  double squared_speed = 0;
  for (const Vec3& velocity : state.velocities) squared_speed = std::max(squared_speed, velocity.squaredNorm());
  return std::sqrt(squared_speed);
}

/// Part of a body's volume at rest up to which it has none.
constexpr double kNoVolume = 1e-3;

void add_crossings(const Crossings& crossings, FrameStatistics& row) {
  const BodyPairCrossings& bodies = crossings.bodies.total;
  row.triangle_pairs = bodies.triangle_pairs;
  row.penetrating_vertices = bodies.vertices;
  row.deepest_penetration = bodies.deepest_vertex;
  row.penetrating_edges = bodies.edges;
  row.deepest_edge = bodies.deepest_edge;
  ColliderCrossings all;
  for (const ColliderCrossings& collider : crossings.colliders) all.add(collider);
  row.vertices_in_colliders = all.vertices;
  row.deepest_in_colliders = all.deepest_vertex;
  row.collider_points = all.points;
  row.deepest_collider_point = all.deepest_point;
}

}  // namespace

FrameMeasures::FrameMeasures(const Scene& scene)
    : scene_(scene),
      energies_(scene.model),
      finder_(scene.model.mesh, scene.initial_state.positions),
      bodies_(scene.model, scene.initial_state.positions),
      colliders_(scene.model, scene.colliders, scene.handles) {}

void FrameMeasures::measure(const State& state, std::int64_t frame, FrameStatistics& row) {
  row.frame = frame;
  row.time = state.time;
  row.steps = state.steps;
  solids_ = measure_solids(scene_.model, state.positions);
  const Energies energies = energies_.measure(state, scene_.options.gravity, solids_);
  row.kinetic_energy = energies.kinetic;
  row.elastic_energy = energies.elastic;
  row.gravity_energy = energies.gravity;
  row.fastest = fastest_of(state);
  row.flat_elements = solids_.flat_elements;
  finder_.update(state.positions);
  row.inverted_elements = finder_.defects().inverted_elements;
  crossings_ = {bodies_.measure(finder_, state.positions), colliders_.measure(finder_, state)};
  add_crossings(crossings_, row);
}

std::vector<Vec3> FrameMeasures::stored_positions(const State& state) {
  const ContactOptions& contact = scene_.options.contact;
  if (contact.guarantee || contact.mode == DetectionMode::kOff) return state.positions;
  return round_to_floats(bodies_.surface(), bodies_.surface_finder(), state.positions, bodies_.pairs());
}

const Body* FrameMeasures::find_body_without_volume() const {
  const auto& bodies = scene_.model.bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (!bodies[b].is_cloth() && solids_.volumes[b].now <= kNoVolume * solids_.volumes[b].at_rest) return &bodies[b];
  return nullptr;
}

bool Crossings::any() const {
  return bodies.total.triangle_pairs > 0 || bodies.total.vertices > 0 ||
         std::ranges::any_of(colliders, &ColliderCrossings::any);
}

}  // namespace selvage
