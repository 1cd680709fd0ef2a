#include "simulation/elements/solid_measure.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "elasticity/neo_hookean.h"
#include "elasticity/volume_spring.h"
#include "simulation/elements/measure_kernel.h"
#include "simulation/elements/ordered_sum.h"
#include "simulation/elements/rows.h"

namespace selvage {

SolidMeasure measure_solids(const Model& model, std::span<const Vec3> positions) {
  SolidMeasure measure;
  const std::vector<double> rows = rows_of(positions), rest_rows = rows_of(model.rest_positions);
  std::vector<BatchMeasure> batches;
  for (const Body& body : model.bodies) {
    const Material& m = body.material;
    const bool springs = m.kind == MaterialKind::kMassSpring;
    const auto elements = std::span(model.mesh.elements()).subspan(body.first_element, body.element_count);
    // Springs between vertices and of volumes come apart from the batches.
    const NeoHookean material = springs ? NeoHookean{0, 0} : NeoHookean::of(m.youngs_modulus, m.poisson_ratio);
    const MeasureTask task{rows.data(),          rest_rows.data(), elements.data(),
                           std::ssize(elements), material.mu,      material.lambda + material.mu};
    batches.resize((elements.size() + kMeasureBatch - 1) / kMeasureBatch);
    parallel_ranges(std::ssize(batches), kGrain / kMeasureBatch, [&](std::int64_t first, std::int64_t last) {
      SELVAGE_DISPATCH(measure_from_rest, task, first, last, batches.data());
    });
    SolidMeasure::Volume& volume = measure.volumes.emplace_back();
    double energy = 0;
    for (const BatchMeasure& batch : batches) {
      energy += batch.energy;
      volume.now += batch.volume;
      volume.at_rest += batch.rest_volume;
      measure.flat_elements += batch.flat_elements;
    }
    if (springs && m.volume_compliance > 0)
      energy = ordered_sum(std::ssize(elements), [&](std::int64_t e) {
        const RestSimplex<3> rest = rest_tetrahedron(elements[e], model.rest_positions);
        return rest.size * VolumeSpring{rest.size / m.volume_compliance}.energy_density(
                               rest.deformation(gather(elements[e], positions)));
      });
    measure.energy += energy;
  }
  return measure;
}

}  // namespace selvage
