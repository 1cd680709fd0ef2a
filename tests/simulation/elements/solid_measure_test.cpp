// What elements store and fill, and which are thin: several side by side, against one by one, on every instruction set.
#include "simulation/elements/solid_measure.h"

#include "core/isa.h"
#include "elasticity/deformation_gradient.h"
#include "elasticity/neo_hookean.h"
#include "simulation/bodies.h"
#include "simulation/elements/measure_kernel.h"
#include "simulation/elements/rows.h"
#include "simulation/time_step/thin_kernel.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace selvage {

namespace scalar {
void measure_from_rest(const MeasureTask&, std::int64_t first, std::int64_t last, BatchMeasure* sums);
void find_thin_batches(const double* rows, const ThinBatch*, std::int64_t first, std::int64_t last,
                       unsigned char* is_thin);
}  // namespace scalar

namespace {

using namespace bodies;

struct MeasureVariant {
  const char* name;
  Isa needs;
  decltype(&scalar::measure_from_rest) measure;
  decltype(&scalar::find_thin_batches) find_thin;
};

std::vector<MeasureVariant> measure_variants() {
  std::vector<MeasureVariant> variants = {
      {"scalar", Isa::baseline, &scalar::measure_from_rest, &scalar::find_thin_batches},
      {"baseline", Isa::baseline, &baseline::measure_from_rest, &baseline::find_thin_batches},
      {"avx2", Isa::avx2, &avx2::measure_from_rest, &avx2::find_thin_batches},
      {"avx512", Isa::avx512, &avx512::measure_from_rest, &avx512::find_thin_batches}};
  std::erase_if(variants, [](const MeasureVariant& variant) { return variant.needs > active_isa(); });
  return variants;
}

/// A block whose elements are bent, and some of them flat or inverted. Their number fills no batch.
struct BentBlock {
  Model model = make(make_box({0.5, 0.5, 0.1}, 0.1), neo_hookean(1e4, 0.4));
  std::vector<Vec3> x = jittered(model.rest_positions, 0.04, 3);

  BentBlock() {
    const VertexTuple<4>& flat = model.mesh.elements()[5];
    x[flat[3]] = (x[flat[0]] + x[flat[1]] + x[flat[2]]) / 3;
    EXPECT_NE(model.mesh.element_count() % kMeasureBatch, 0);
  }
};

TEST(SolidMeasure, IsTheSumOverElementsOneByOne) {
  const BentBlock block;
  const NeoHookean material = NeoHookean::of(1e4, 0.4);
  double energy = 0, volume = 0, at_rest = 0;
  std::int64_t inverted = 0;
  for (const auto& element : block.model.mesh.elements()) {
    const RestSimplex<3> rest = rest_tetrahedron(element, block.model.rest_positions);
    energy += rest.size * material.energy_density(rest.deformation(gather(element, block.x)));
    const double own = element_volume(element, block.x);
    volume += own;
    at_rest += rest.size;
    inverted += own < 0;
  }
  EXPECT_GT(inverted, 0);
  const SolidMeasure measure = measure_solids(block.model, block.x);
  EXPECT_NEAR(measure.energy, energy, 1e-12 * energy);
  ASSERT_EQ(measure.volumes.size(), 1u);
  EXPECT_NEAR(measure.volumes[0].now, volume, 1e-14);
  EXPECT_NEAR(measure.volumes[0].at_rest, at_rest, 1e-14);
  EXPECT_EQ(measure.flat_elements, 1);
}

TEST(SolidMeasure, HasTheSameBitsOnEveryInstructionSet) {
  const BentBlock block;
  const std::vector<double> rows = rows_of(block.x), rest_rows = rows_of(block.model.rest_positions);
  const auto elements = block.model.mesh.elements();
  const MeasureTask task{rows.data(), rest_rows.data(), elements.data(), std::ssize(elements), 3, 5};
  const std::int64_t batches = (std::ssize(elements) + kMeasureBatch - 1) / kMeasureBatch;
  std::vector<BatchMeasure> expected(batches);
  scalar::measure_from_rest(task, 0, batches, expected.data());
  for (const MeasureVariant& variant : measure_variants()) {
    std::vector<BatchMeasure> sums(batches);
    variant.measure(task, 0, batches, sums.data());
    EXPECT_EQ(std::memcmp(sums.data(), expected.data(), sizeof(BatchMeasure) * batches), 0) << variant.name;
  }
}

TEST(ThinElements, AreThoseOfLittleVolumeOnEveryInstructionSet) {
  const BentBlock block;
  const auto elements = block.model.mesh.elements();
  const std::int64_t count = (std::ssize(elements) + kThinBatch - 1) / kThinBatch;
  std::vector<ThinBatch> batches(count);
  std::vector<unsigned char> expected(count, 0);
  for (std::int64_t e = 0; e < count * kThinBatch; ++e) {
    ThinBatch& batch = batches[e / kThinBatch];
    batch.least[e % kThinBatch] = -std::numeric_limits<double>::infinity();
    if (e >= std::ssize(elements)) continue;
    const double least = 0.1 * element_volume(elements[e], block.model.rest_positions);
    for (int k = 0; k < 4; ++k) batch.rows[k][e % kThinBatch] = 4 * elements[e][k];
    batch.least[e % kThinBatch] = 6 * least;
    if (element_volume(elements[e], block.x) < least) expected[e / kThinBatch] = 1;
  }
  const std::vector<double> rows = rows_of(block.x);
  const auto thin = std::count(expected.begin(), expected.end(), 1);
  EXPECT_GT(thin, 0);
  EXPECT_LT(thin, count);
  for (const MeasureVariant& variant : measure_variants()) {
    std::vector<unsigned char> found(count, 7);
    variant.find_thin(rows.data(), batches.data(), 0, count, found.data());
    EXPECT_EQ(found, expected) << variant.name;
  }
}

}  // namespace
}  // namespace selvage
