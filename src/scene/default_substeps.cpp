#include "elasticity/deformation_gradient.h"
#include "scene/description/scene_description.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace selvage {

namespace {

constexpr double kSubsteps = 5, kClothSubsteps = 10, kMaxSubsteps = 50;

/// Mass for its size, per area [kg/m2]: what a sheet that catches the body has to carry.
double load_of(const Body& body, const Model& model) {
  double mass = 0, volume = 0;
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
    if (model.inverse_masses[v] > 0) mass += 1 / model.inverse_masses[v];
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e)
    volume += element_volume(model.mesh.elements()[e], model.rest_positions);
  return mass / std::pow(volume, 2.0 / 3);
}

}  // namespace

int default_substeps(const Model& model, SolverKind solver, double frame_length, double max_speed) {
  if (solver != SolverKind::kXpbd) return kSubsteps;
  constexpr double kSameDensities = 5, kSameLoads = 167, kEdgesAStep = 0.5;
  double lightest = std::numeric_limits<double>::infinity(), heaviest = 0, load = 0;
  double sheet = std::numeric_limits<double>::infinity();
  double edges = 0;  // that a body flies past in a frame
  for (const Body& body : model.bodies) {
    const double speed = std::min(body.initial_velocity.norm(), max_speed);
    edges = std::max(edges, speed * frame_length / mean_edge_of(model, body));
    if (body.is_cloth()) {
      sheet = std::min(sheet, body.cloth.density);
      continue;
    }
    lightest = std::min(lightest, body.material.density);
    heaviest = std::max(heaviest, body.material.density);
    load = std::max(load, load_of(body, model));
  }
  const bool cloth = std::isfinite(sheet);
  const double for_densities =
      (cloth ? kClothSubsteps : kSubsteps) * std::sqrt(std::max(heaviest / lightest / kSameDensities, 1.0));
  const double for_loads = cloth ? kClothSubsteps * std::sqrt(load / sheet / kSameLoads) : 0;
  return static_cast<int>(std::min(std::ceil(std::max({for_densities, for_loads, edges / kEdgesAStep})), kMaxSubsteps));
}

}  // namespace selvage
