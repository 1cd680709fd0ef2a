#pragma once

#include "selvage/simulation/model.h"
#include "simulation/elements/solid_measure.h"
#include "simulation/implicit/cloth_terms.h"

namespace selvage {

/// Energies of a state [J].
struct Energies {
  double kinetic = 0;
  double elastic = 0;  ///< of elements, springs, cloth and its bends; 0 at rest
  double gravity = 0;  ///< 0 where all masses are in the origin
};

/// Measures the energies of states of one model: by the materials alone, whatever solver made the states.
///
/// A rigid spring or volume (a compliance of 0) stores nothing. What is pinned for ever has no mass, and so neither
/// kinetic energy nor weight. The same bits for any number of threads.
class EnergyMeasure {
 public:
  /// @param model  must outlive this
  explicit EnergyMeasure(const Model& model);

  /// @param solids  measure_solids() of the state
  /// O(n_vertices + n_triangles).
  Energies measure(const State& state, const Vec3& gravity, const SolidMeasure& solids) const;

 private:
  struct Spring {
    VertexTuple<2> vertices;
    Index body;
  };

  double spring_energy(const Spring& spring, std::span<const Vec3> x) const;

  const Model& model_;
  std::vector<Spring> springs_;  ///< edges of mass-spring bodies
  ClothTerms cloth_;
};

}  // namespace selvage
