#pragma once

#include "selvage/simulation/model.h"

namespace selvage {

/// What the elements of a state store and fill.
struct SolidMeasure {
  /// Of a body; 0 of cloth.
  struct Volume {
    double now = 0, at_rest = 0;  ///< [m^3], with inverted elements below 0
  };

  double energy = 0;               ///< of materials, without edge springs; 0 at rest [J]
  std::int64_t flat_elements = 0;  ///< inverted or not, with hardly any volume
  std::vector<Volume> volumes;     ///< (n_bodies)
};

/// The same bits for every instruction set and any number of threads. O(n_vertices + n_elements).
SolidMeasure measure_solids(const Model& model, std::span<const Vec3> positions);

}  // namespace selvage
