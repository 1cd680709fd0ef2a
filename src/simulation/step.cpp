#include "simulation/step.h"

#include <algorithm>

namespace selvage {

namespace {

/// Fraction of a vertex's shortest edge by which one projection moves it at most.
constexpr double kMaxCorrection = 0.25;

}  // namespace

std::vector<double> max_corrections_of(const Model& model) {
  std::vector<double> corrections(model.mesh.vertex_count(), 0);
  const auto add = [&](std::span<const Index> vertices) {
    for (const Index v : vertices)
      for (const Index w : vertices) {
        if (v == w) continue;
        const double correction = kMaxCorrection * (model.rest_positions[v] - model.rest_positions[w]).norm();
        if (corrections[v] == 0 || correction < corrections[v]) corrections[v] = correction;
      }
  };
  for (const auto& element : model.mesh.elements()) add(element);
  for (const auto& triangle : model.triangles) add(triangle);
  return corrections;
}

}  // namespace selvage
