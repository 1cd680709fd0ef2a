#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// Energy of the Neo-Hookean Material in an element, for a Young's modulus of 1 Pa; 0 at rest [J].
double element_energy(const VertexTuple<4>& element, std::span<const Vec3> rest, std::span<const Vec3> positions,
                      double poisson_ratio);

}  // namespace selvage
