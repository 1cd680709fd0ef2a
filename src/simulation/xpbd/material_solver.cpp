#include "simulation/xpbd/material_solver.h"

#include "core/phases.h"

namespace selvage {

namespace {

/// Least hydrostatic stiffness, as a fraction of the deviatoric one: without any the compliance would be infinite.
constexpr double kMinHydrostatic = 1e-12;
/// Longest damping in time steps. It stiffens the system that the few iterations of a step solve: with more they leave
/// most of the elastic force out, and a material sinks under its load.
constexpr double kMaxDamping = 3;
/// No volume is less.
constexpr double kNothingInverted = -std::numeric_limits<double>::infinity();

MaterialStep prepare(const Material& material, double time_step) {
  const double squared_step = time_step * time_step;
  MaterialStep step{.kind = material.kind,
                    .deviatoric = 0,
                    .hydrostatic = 0,
                    .edge = material.edge_compliance / squared_step,
                    .damping = std::min(material.damping / time_step, kMaxDamping),
                    .inverted = 0};
  if (material.kind == MaterialKind::kNeoHookean) {
    const auto [mu, lambda] = lame_parameters(material.youngs_modulus, material.poisson_ratio);
    step.deviatoric = 6 / (mu * squared_step);
    step.hydrostatic = 6 / (std::max(lambda, kMinHydrostatic * mu) * squared_step);
  } else {
    step.hydrostatic = 36 * material.volume_compliance / squared_step;
  }
  return step;
}

}  // namespace

MaterialSolver::MaterialSolver(const Model& model, double time_step)
    : model_(model), blocks_(make_material_blocks(model)) {
  for (const Body& body : model.bodies) bodies_.push_back(prepare(body.material, time_step));
}

bool MaterialSolver::needs_start() const {
  return std::any_of(bodies_.begin(), bodies_.end(), [](const MaterialStep& step) { return step.damping > 0; });
}

void MaterialSolver::turn_back(std::span<const Index> vertices) {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Body& body = model_.bodies[b];
    const auto first = std::lower_bound(vertices.begin(), vertices.end(), body.first_vertex);
    const bool has_any = first != vertices.end() && *first < body.first_vertex + body.vertex_count;
    bodies_[b].inverted = has_any ? 0 : kNothingInverted;
  }
}

void MaterialSolver::solve_best(const MaterialTask& task, Index first, Index last) {
  SELVAGE_DISPATCH(solve_blocks, task, first, last);
}

void MaterialSolver::solve(std::span<StepVertex> vertices, std::span<const StepVertex> start, int first, int last,
                           void (*kernel)(const MaterialTask&, Index first, Index last)) {
  MaterialTask task{.vertices = vertices.data(),
                    .start = start.data(),
                    .block_vertices = blocks_.vertices.data(),
                    .elements = blocks_.elements.data(),
                    .edges = blocks_.edges.data(),
                    .blocks = blocks_.blocks.data(),
                    .bodies = bodies_.data(),
                    .is_first = true,
                    .next_block = 0};
  for (int iteration = first; iteration < last; ++iteration) {
    task.is_first = iteration == 0;
    parallel_phases(blocks_.colour_first, [&](Index subdomain, Index next_subdomain) {
      MaterialTask of_subdomain = task;
      of_subdomain.next_block = blocks_.subdomain_first[next_subdomain];
      kernel(of_subdomain, blocks_.subdomain_first[subdomain], blocks_.subdomain_first[subdomain + 1]);
    });
  }
}

}  // namespace selvage
