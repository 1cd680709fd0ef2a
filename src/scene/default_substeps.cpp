#include "scene/default_substeps.h"

#include "elasticity/deformation_gradient.h"
#include "simulation/time_step/sleep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <set>
#include <span>
#include <utility>

namespace selvage {

namespace {

constexpr double kSubsteps = 5, kClothSubsteps = 10, kMaxSubsteps = 50, kMaxSubstepsOfBlocks = 200;

double volume_of(const Body& body, const Model& model) {
  double volume = 0;
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e)
    volume += element_volume(model.mesh.elements()[e], model.rest_positions);
  return volume;
}

/// Areas of the boundaries of all bodies of elements.
std::vector<double> areas_of(const Model& model) {
  std::vector<double> areas(model.bodies.size(), 0.0);
  const std::vector<Index> body_of = bodies_of_vertices(model);
  for (const auto& [a, b, c] : model.mesh.boundary_faces()) {
    const Vec3& p = model.rest_positions[a];
    areas[body_of[a]] += (model.rest_positions[b] - p).cross(model.rest_positions[c] - p).norm() / 2;
  }
  return areas;
}

/// Mass for its size, per area [kg/m2]: what a sheet that catches the body has to carry.
double load_of(const Body& body, const Model& model) {
  double mass = 0;
  for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v)
    if (model.inverse_masses[v] > 0) mass += 1 / model.inverse_masses[v];
  return mass / std::pow(volume_of(body, model), 2.0 / 3);
}

/// A body that may carry others of its kind: towers are built of these. Rings, rods and arms give way by their shape.
struct Block {
  double size;          ///< edge of a cube of its volume [m]
  double edges_across;  ///< of its elements
  double density;
};

std::vector<Block> blocks_of(const Model& model, std::span<const double> areas) {
  constexpr double kLeastCompact = 0.3;  // 1 of balls, 0.52 of cubes, 0.33 of bricks
  std::vector<Block> blocks;
  for (std::size_t b = 0; b < areas.size(); ++b) {
    const Body& body = model.bodies[b];
    if (body.is_cloth()) continue;
    const double volume = volume_of(body, model), size = std::cbrt(volume);
    if (36 * std::numbers::pi * volume * volume < kLeastCompact * areas[b] * areas[b] * areas[b]) continue;
    blocks.push_back({size, size / mean_edge_of(model, body), body.material.density});
  }
  return blocks;
}

/// Steps in which each block carries the densest other of its own size, or a slice of whatever is much denser, by the
/// stiffness of its material. In fewer it gives way like a softer one: by the pressure over the density, the square of
/// an edge and of the number of steps. So towers lean, and fall. Measured on these: see docs/notes/simulation.md.
double substeps_for_blocks(const Model& model, double gravity, double frame_length) {
  constexpr double kSameDensities = 5, kSubstepsThen = 8.5, kExponent = 0.7;
  constexpr double kEdgesAcross = 3.3, kSize = 0.4, kGravity = 9.81, kFrameLength = 1.0 / 60;  // of the towers
  const std::vector<double> areas = areas_of(model);
  const std::vector<Block> blocks = blocks_of(model, areas);
  std::array<double, 2> densest{};  // the most first
  for (const Block& block : blocks) {
    densest[1] = std::max(densest[1], std::min(block.density, densest[0]));
    densest[0] = std::max(densest[0], block.density);
  }
  std::set<std::pair<double, double>> loads;  // densities, and thicknesses [m]: of cubes their edges, of plates thrice
  for (std::size_t b = 0; b < areas.size(); ++b)
    if (const Body& body = model.bodies[b]; !body.is_cloth())
      loads.insert({body.material.density, 6 * volume_of(body, model) / areas[b]});
  double steps = 0;
  for (const Block& block : blocks) {
    double other = block.density < densest[0] ? densest[0] : densest[1];
    for (const auto& [density, thickness] : loads)
      if (const double load = density * std::min(1.0, thickness / block.size); load > kSameDensities * block.density)
        other = std::max(other, load);
    steps = std::max(steps, kSubstepsThen * std::pow(other / block.density / kSameDensities, kExponent) *
                                (block.edges_across / kEdgesAcross) *
                                std::sqrt(gravity / kGravity * kSize / block.size) * (frame_length / kFrameLength));
  }
  return steps;
}

/// How a body is pressed.
enum class Pressure : std::uint8_t { kSlight, kThin, kCrushed };

/// Thin: more than one in a thousand elements have less than a tenth of their volume. Crushed: all together have less
/// than half of it.
Pressure pressure_on(const Body& body, const Model& model, std::span<const Vec3> positions) {
  constexpr double kThin = 0.1, kCrushed = 0.5;
  constexpr std::int64_t kFew = 3, kShare = 1000;
  std::int64_t thin = 0;
  double volume = 0, at_rest = 0;
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
    const auto& element = model.mesh.elements()[e];
    const double now = element_volume(element, positions), rest = element_volume(element, model.rest_positions);
    thin += now < kThin * rest ? 1 : 0;
    volume += now;
    at_rest += rest;
  }
  if (volume < kCrushed * at_rest) return Pressure::kCrushed;
  return thin > kFew && kShare * thin > body.element_count ? Pressure::kThin : Pressure::kSlight;
}

/// By its halved steps how often those of a frame were halved.
int halvings_of(const FrameStatistics& row, int substeps) {
  int halvings = 0;
  while (row.halved_steps >= substeps * ((std::int64_t{2} << halvings) - 1)) ++halvings;
  return halvings;
}

}  // namespace

int default_substeps(const Model& model, SolverKind solver, double frame_length, const StepOptions& options) {
  if (solver != SolverKind::kXpbd) return kSubsteps;
  constexpr double kSameDensities = 5, kSameLoads = 167, kEdgesAStep = 0.5;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double load = 0, sheet = kInfinity, lightest = kInfinity;
  double heaviest = 0;
  double edges = 0;  // that a body flies past in a frame
  for (const Body& body : model.bodies) {
    const double speed = std::min(body.initial_velocity.norm(), options.max_speed);
    edges = std::max(edges, speed * frame_length / mean_edge_of(model, body));
    if (body.is_cloth()) {
      sheet = std::min(sheet, body.cloth.density);
      continue;
    }
    heaviest = std::max(heaviest, body.material.density);
    lightest = std::min(lightest, body.material.density);
    load = std::max(load, load_of(body, model));
  }
  const bool cloth = std::isfinite(sheet);
  const double least = cloth ? kClothSubsteps : kSubsteps;
  const double for_densities = least * std::sqrt(heaviest / lightest / kSameDensities);
  const double for_loads = cloth ? kClothSubsteps * std::sqrt(load / sheet / kSameLoads) : 0;
  const double for_others = std::clamp(std::max({for_densities, for_loads, edges / kEdgesAStep}), least, kMaxSubsteps);
  const double for_blocks = substeps_for_blocks(model, options.gravity.norm(), frame_length);
  return static_cast<int>(std::ceil(std::max(for_others, std::min(for_blocks, kMaxSubstepsOfBlocks))));
}

int default_halvings(const Scene& scene, const State& state, std::span<const FrameStatistics> rows) {
  if (!scene.may_halve_steps) return 0;
  bool is_thin = false;
  for (std::size_t b = 0; b < scene.model.bodies.size(); ++b) {
    if (!state.rest_times.empty() && state.rest_times[b] >= kSleepTime) continue;
    const Pressure pressure = pressure_on(scene.model.bodies[b], scene.model, state.positions);
    if (pressure == Pressure::kCrushed) return 0;
    is_thin |= pressure == Pressure::kThin;
  }
  const FrameStatistics& last = rows.back();
  const auto halvings = [&](const FrameStatistics& row) { return halvings_of(row, scene.substeps); };
  const int now = halvings(last);
  const auto all_of_last = [&](double seconds, auto&& holds) {
    const auto frames = static_cast<std::size_t>(std::ceil(seconds * scene.frames_per_second));
    return rows.size() >= frames && std::all_of(rows.end() - frames, rows.end(), [&](const FrameStatistics& row) {
             return halvings(row) == now && holds(row);
           });
  };
  constexpr int kMaxHalvings = 2, kMaxParts = 30;
  constexpr double kPatience[kMaxHalvings] = {0.25, 1}, kCalm = 1;  // [s]
  const bool is_free =
      last.penetrating_vertices + last.penetrating_edges + last.triangle_pairs + last.vertices_in_colliders == 0;
  if (is_thin && is_free && now < kMaxHalvings && scene.substeps << (now + 1) <= kMaxParts &&
      all_of_last(kPatience[now], [](const FrameStatistics& row) { return row.held_back_vertices > 0; }))
    return now + 1;
  const bool has_fallen = std::ranges::adjacent_find(rows, std::greater{}, halvings) != rows.end();
  if (!is_thin && now > 0 && !has_fallen && all_of_last(kCalm, [](const FrameStatistics&) { return true; })) return 0;
  return now;
}

}  // namespace selvage
