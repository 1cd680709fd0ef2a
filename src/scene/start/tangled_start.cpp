#include "scene/start/tangled_start.h"

#include "mesh/find_inverted.h"

#include <algorithm>

namespace selvage {

namespace {

/// Part of the vertices of a body's boundary that are inside the body, above which it is resolved.
constexpr double kTangledShare = 0.1;

bool is_of(const Body& body, Index vertex) {
  return vertex >= body.first_vertex && vertex - body.first_vertex < body.vertex_count;
}

bool is_tangled(const Scene& scene, const BodyPairCrossings& pair) {
  if (pair.first != pair.second) return false;
  const Body& body = scene.model.bodies[static_cast<std::size_t>(pair.first)];
  const auto count =
      std::ranges::count_if(scene.model.mesh.boundary_vertices(), [&](Index v) { return is_of(body, v); });
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

/// Vertices of a body that its start must not move.
std::vector<Index> held_vertices(const Body& body, const Scene& scene) {
  std::vector<Index> held;
  for (Index i = 0; i < body.vertex_count; ++i)
    if (scene.model.inverse_masses[body.first_vertex + i] == 0) held.push_back(i);
  for (const Handle& handle : scene.handles)
    for (const Index v : handle.vertices)
      if (is_of(body, v) && handle.release_time > 0) held.push_back(v - body.first_vertex);
  return held;
}

}  // namespace

Index resolve_tangled_start(const Scene& scene, const BodyCrossings& crossings, State& state,
                            const std::function<void(const StartProgress&)>& on_iteration) {
  Index moved = 0;
  for (const BodyPairCrossings& pair : crossings.pairs) {
    if (!is_tangled(scene, pair)) continue;
    const Body& body = scene.model.bodies[static_cast<std::size_t>(pair.first)];
    const auto first = state.positions.begin() + body.first_vertex;
    std::vector<Vec3> positions(first, first + body.vertex_count);
    const TetMesh mesh = mesh_of(body, scene.model);
    ResolveOptions options{.pinned = held_vertices(body, scene)};
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
