#include "scene/start/tangled_start.h"

#include "mesh/find_inverted.h"

#include <algorithm>

namespace selvage {

namespace {

/// Part of the vertices of a body's boundary that are inside the body, above which it is resolved.
constexpr double kTangledShare = 0.1;

bool is_tangled(const Model& model, std::span<const Index> body_of, const BodyPairCrossings& pair) {
  if (pair.first != pair.second) return false;
  const auto count =
      std::ranges::count_if(model.mesh.boundary_vertices(), [&](Index v) { return body_of[v] == pair.first; });
  return static_cast<double>(pair.vertices) > kTangledShare * static_cast<double>(count);
}

/// A body alone, its vertices numbered from 0.
TetMesh mesh_of(const Body& body, const Model& model) {
  std::vector<VertexTuple<4>> elements;
  for (VertexTuple<4> element : model.mesh.elements().subspan(body.first_element, body.element_count)) {
    for (Index& v : element) v -= body.first_vertex;
    elements.push_back(element);
  }
  return {body.vertex_count, std::move(elements)};
}

/// Vertices of a body that its start must not move, numbered as in mesh_of().
std::vector<Index> held_vertices(Index b, const Scene& scene, std::span<const Index> body_of) {
  const Body& body = scene.model.bodies[static_cast<std::size_t>(b)];
  std::vector<Index> held;
  for (Index i = 0; i < body.vertex_count; ++i)
    if (scene.model.inverse_masses[body.first_vertex + i] == 0) held.push_back(i);
  for (const Handle& handle : scene.handles)
    for (const Index v : handle.vertices)
      if (body_of[v] == b && handle.release_time > 0) held.push_back(v - body.first_vertex);
  return held;
}

}  // namespace

Index resolve_tangled_start(const Scene& scene, const BodyCrossings& crossings, State& state,
                            const std::function<void(const StartProgress&)>& on_iteration) {
  const std::vector<Index> body_of = bodies_of_vertices(scene.model);
  Index moved = 0;
  for (const BodyPairCrossings& pair : crossings.pairs) {
    if (!is_tangled(scene.model, body_of, pair)) continue;
    const Body& body = scene.model.bodies[static_cast<std::size_t>(pair.first)];
    const auto first = state.positions.begin() + body.first_vertex;
    std::vector<Vec3> positions(first, first + body.vertex_count);
    const TetMesh mesh = mesh_of(body, scene.model);
    ResolveOptions options{.pinned = held_vertices(pair.first, scene, body_of)};
    if (!find_inverted(mesh, positions).empty()) {
      const auto rest = scene.model.rest_positions.begin() + body.first_vertex;
      options.rest_positions.assign(rest, rest + body.vertex_count);
    }
    if (on_iteration)
      options.on_iteration = [&](const ResolveIteration& iteration) { on_iteration({pair.first, iteration}); };
    if (resolve_collisions(mesh, positions, options).outcome != ResolveOutcome::kResolved) continue;
    std::ranges::copy(positions, first);
    ++moved;
  }
  return moved;
}

}  // namespace selvage
