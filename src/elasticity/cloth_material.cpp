#include "selvage/elasticity/cloth_material.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace selvage {

void check_material(std::string_view where, const ClothMaterial& m) {
  const auto demand = [&](std::string_view name, double value, bool is_good, std::string_view range) {
    if (!is_good || !std::isfinite(value))
      throw Error(where, fmt::format("its {} is {}", name, value), fmt::format("give a number {}", range));
  };
  constexpr std::string_view kPositive = "above 0", kNotNegative = "that is not negative";
  demand("density", m.density, m.density > 0, kPositive);
  demand("bending stiffness", m.bending, m.bending >= 0, kNotNegative);
  demand("thickness", m.thickness, m.thickness >= 0, kNotNegative);
  demand("damping", m.damping, m.damping >= 0, kNotNegative);
  demand("damping of bends", m.bending_damping.value_or(0), m.bending_damping.value_or(0) >= 0, kNotNegative);
  if (m.kind == ClothKind::kIsotropic) {
    demand("stiffness", m.stiffness, m.stiffness > 0, kPositive);
    demand("Poisson's ratio", m.poisson_ratio, m.poisson_ratio >= 0 && m.poisson_ratio <= 0.5,
           "of at least 0 and at most 0.5");
  } else {
    demand("warp stiffness", m.warp, m.warp > 0, kPositive);
    demand("weft stiffness", m.weft, m.weft > 0, kPositive);
    demand("shear stiffness", m.shear, m.shear > 0, kPositive);
    demand("warp direction", m.warp_direction.norm(), m.warp_direction.norm() > 0, "of a direction");
  }
}

}  // namespace selvage
