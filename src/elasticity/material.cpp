#include "selvage/elasticity/material.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace selvage {

LameParameters lame_parameters(double youngs_modulus, double poisson_ratio) {
  const double mu = youngs_modulus / (2 * (1 + poisson_ratio));
  return {mu, 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio)};
}

void check_material(std::string_view where, const Material& m) {
  const auto demand = [&](std::string_view name, double value, bool is_good, std::string_view range) {
    if (!is_good || !std::isfinite(value))
      throw Error(where, fmt::format("its {} is {}", name, value), fmt::format("give a number {}", range));
  };
  demand("density", m.density, m.density > 0, "above 0");
  demand("damping", m.damping, m.damping >= 0, "that is not negative");
  if (m.kind == MaterialKind::kNeoHookean) {
    demand("Young's modulus", m.youngs_modulus, m.youngs_modulus > 0, "above 0");
    demand("Poisson's ratio", m.poisson_ratio, m.poisson_ratio >= 0 && m.poisson_ratio < 0.5,
           "of at least 0 and below 0.5");
  } else {
    demand("edge compliance", m.edge_compliance, m.edge_compliance >= 0, "that is not negative");
    demand("volume compliance", m.volume_compliance, m.volume_compliance >= 0, "that is not negative");
  }
}

}  // namespace selvage
