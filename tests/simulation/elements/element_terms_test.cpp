// Elements side by side, against the same one by one, on every instruction set.
#include "simulation/elements/element_terms.h"
#include "core/isa.h"
#include "simulation/bodies.h"
#include "simulation/elements/rows.h"

#include <Eigen/Eigenvalues>

namespace selvage {

namespace scalar {
void measure_elements(const ElementTask&, std::int64_t first, std::int64_t last, double* energies);
void pull_elements(const ElementTask&, std::int64_t first, std::int64_t last, ElementGradient* gradients);
void differentiate_elements(const ElementTask&, bool is_exact, std::int64_t first, std::int64_t last,
                            ElementDerivatives* derivatives);
}  // namespace scalar

namespace {

using namespace bodies;

constexpr double kStep = 1.0 / 120;

struct ElementVariant {
  const char* name;
  Isa needs;
  decltype(&scalar::measure_elements) measure;
  decltype(&scalar::pull_elements) pull;
  decltype(&scalar::differentiate_elements) differentiate;
};

std::vector<ElementVariant> element_variants() {
  std::vector<ElementVariant> variants = {
      {"scalar", Isa::baseline, &scalar::measure_elements, &scalar::pull_elements, &scalar::differentiate_elements},
      {"baseline", Isa::baseline, &baseline::measure_elements, &baseline::pull_elements,
       &baseline::differentiate_elements},
      {"avx2", Isa::avx2, &avx2::measure_elements, &avx2::pull_elements, &avx2::differentiate_elements},
      {"avx512", Isa::avx512, &avx512::measure_elements, &avx512::pull_elements, &avx512::differentiate_elements}};
  std::erase_if(variants, [](const ElementVariant& variant) { return variant.needs > active_isa(); });
  return variants;
}

template <typename Item>
void expect_same_bits(const std::vector<Item>& a, const std::vector<Item>& b, const char* name) {
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(Item) * (a.size() - 1)), 0) << name;
}

/// Energy, gradient and Hessian of an element by the densities alone.
struct OneByOne {
  double energy = 0;
  StencilGradient<4> gradient = StencilGradient<4>::Zero();
  StencilHessian<4> exact = StencilHessian<4>::Zero(), positive = exact;

  template <typename Density>
  void add(const RestSimplex<3>& rest, const Density& density, const StencilPositions<4>& x) {
    const SimplexElement<3, Density> element{rest, density};
    energy += element.energy(x);
    gradient += element.gradient(x);
    exact += element.hessian(x);
    positive += element.positive_hessian(x);
  }
};

OneByOne of_one(const Model& model, const Material& m, Index e, std::span<const Vec3> start, std::span<const Vec3> x) {
  const auto& vertices = model.mesh.elements()[e];
  const RestSimplex<3> rest = rest_tetrahedron(vertices, model.rest_positions);
  const StencilPositions<4> own = gather(vertices, x);
  const Eigen::Matrix3d f = rest.deformation(gather(vertices, start));
  const double damping = m.damping / kStep;
  OneByOne sum;
  if (m.kind == MaterialKind::kMassSpring) {
    const VolumeSpring spring{rest.size / m.volume_compliance};
    sum.add(rest, spring, own);
    if (damping > 0) sum.add(rest, VolumeSpring{damping * spring.stiffness, f.determinant()}, own);
  } else {
    const NeoHookean solid = NeoHookean::of(m.youngs_modulus, m.poisson_ratio);
    sum.add(rest, solid, own);
    if (damping > 0)
      sum.add(rest, StrainDamping<3>{damping * solid.mu, damping * solid.lambda, f.transpose() * f}, own);
  }
  return sum;
}

/// All blocks of one.
StencilHessian<4> whole(const ElementDerivatives& derivatives) {
  StencilHessian<4> h = StencilHessian<4>::Zero();
  for (int k = 0; k < 4; ++k)
    for (int l = 0; l < 4; ++l) {
      if (k == l) continue;
      h.block<3, 3>(3 * k, 3 * l) = block_of(derivatives, k, l);
      h.block<3, 3>(3 * k, 3 * k) -= h.block<3, 3>(3 * k, 3 * l);
    }
  return h;
}

void compare_variants(const ElementTerms& terms, std::span<const Vec3> x) {
  const std::vector<double> rows = rows_of(x);
  const auto batches = std::ssize(terms.batches());
  const std::size_t records = terms.record_count();
  std::vector<double> energies;
  std::vector<ElementGradient> gradients;
  std::vector<ElementDerivatives> derivatives[2];
  for (const ElementVariant& variant : element_variants()) {
    std::vector<double> own(records);
    variant.measure(terms.task(rows), 0, batches, own.data());
    std::vector<ElementGradient> pulls(records);
    variant.pull(terms.task(rows), 0, batches, pulls.data());
    std::vector<ElementDerivatives> both[2] = {std::vector<ElementDerivatives>(records),
                                               std::vector<ElementDerivatives>(records)};
    for (const int exact : {0, 1}) variant.differentiate(terms.task(rows), exact != 0, 0, batches, both[exact].data());
    if (energies.empty()) {
      energies = own;
      gradients = pulls;
      for (const int exact : {0, 1}) derivatives[exact] = both[exact];
    }
    expect_same_bits(own, energies, variant.name);
    expect_same_bits(pulls, gradients, variant.name);
    for (const int exact : {0, 1}) expect_same_bits(both[exact], derivatives[exact], variant.name);
  }
}

void compare_with_one_by_one(const Model& model, const Material& material, std::span<const Vec3> start,
                             std::span<const Vec3> x) {
  ElementTerms terms(model, kStep);
  terms.begin(start);
  compare_variants(terms, x);
  std::vector<ElementGradient> gradients;
  std::vector<ElementDerivatives> exact, positive;
  terms.find_gradients(x, gradients);
  terms.differentiate(x, true, exact);
  terms.differentiate(x, false, positive);
  double energy = 0, sizes = 0;
  for (Index e = 0; e < terms.count(); ++e) {
    const OneByOne own = of_one(model, material, e, start, x);
    energy += own.energy;
    sizes += std::abs(own.energy);
    const double size = own.exact.norm(), pull = own.gradient.norm() + 1e-3 * size;
    EXPECT_LE((whole(exact[e]) - own.exact).norm(), 1e-12 * size) << e;
    EXPECT_LE((whole(positive[e]) - own.positive).norm(), 1e-9 * size) << e;
    for (int k = 0; k < 4; ++k) {
      EXPECT_LE((gradient_of(gradients[e].of_vertex, k) - own.gradient.col(k)).norm(), 1e-12 * pull) << e;
      EXPECT_LE((gradient_of(exact[e].gradient, k) - own.gradient.col(k)).norm(), 1e-12 * pull) << e;
      EXPECT_LE((gradient_of(positive[e].gradient, k) - own.gradient.col(k)).norm(), 1e-12 * pull) << e;
    }
    const Eigen::SelfAdjointEigenSolver<StencilHessian<4>> eigen(whole(positive[e]), Eigen::EigenvaluesOnly);
    EXPECT_GE(eigen.eigenvalues()[0], -1e-11 * size) << e;
  }
  // Near rest large terms cancel.
  EXPECT_NEAR(terms.energy(x), energy, 1e-12 * sizes + 1e-16 * material.youngs_modulus);
}

void compare_poses(const Model& model, const Material& material) {
  const std::vector<Vec3>& rest = model.rest_positions;
  const std::vector<Vec3> start = jittered(rest, 0.01, 5);
  for (const double reach : {0.0, 1e-6, 1e-3, 0.02, 0.3})
    compare_with_one_by_one(model, material, start, jittered(rest, reach, 7));
  std::vector<Vec3> pressed = rest, turned_over = rest, flat = rest, line = rest, point = rest;
  for (Vec3& p : pressed) p *= 0.6;
  for (Vec3& p : turned_over) p[0] *= -1;
  for (Vec3& p : flat) p[2] = 0;
  for (Vec3& p : line) p[1] = p[2] = 0;
  for (Vec3& p : point) p = Vec3(1, 2, 3);
  for (const std::vector<Vec3>& x : {pressed, turned_over, flat, line, point})
    compare_with_one_by_one(model, material, start, x);
}

TEST(ElementTerms, AreWhatMaterialAndDampingAreOneByOneOnEveryInstructionSet) {
  const std::vector<IndexedMesh> meshes{make_ball(0.3, 0.15), moved(make_box({0.3, 0.2, 0.1}, 0.1), {1, 0, 0})};
  for (const double damping : {0.0, 0.01})
    for (const double ratio : {0.0, 0.4, 0.499}) {
      const Material material = damped(neo_hookean(1e5, ratio), damping);
      compare_poses(make(meshes, material), material);
    }
}

TEST(ElementTerms, LeaveMassSpringBodiesOneByOne) {
  for (const double damping : {0.0, 0.01}) {
    const Material material = damped(springs(1e-4, 1e-9), damping);
    const Model model = make(make_box({0.3, 0.2, 0.1}, 0.1), material);
    EXPECT_TRUE(ElementTerms(model, kStep).batches().empty());
    compare_poses(model, material);
  }
}

}  // namespace
}  // namespace selvage
