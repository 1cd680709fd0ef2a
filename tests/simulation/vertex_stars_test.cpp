// The elements of a vertex side by side, against the same one by one, on every instruction set.
#include "simulation/vbd/vertex_stars.h"
#include "core/isa.h"
#include "simulation/cloth_bodies.h"
#include "simulation/vbd/vertex_colours.h"

namespace selvage {

namespace scalar {
void sum_stars(const StarTask&, Index first, Index last, StarSums* sums);
void sum_cloth_star(const ClothStarTask&, Index star, ClothStarSums& sums);
void measure_cloth_star(const ClothStarTask&, Index star, const double at[3], double& energy);
}  // namespace scalar

namespace {

using namespace bodies;

struct StarVariant {
  const char* name;
  Isa needs;
  void (*sum)(const StarTask&, Index, Index, StarSums*);
};

std::vector<StarVariant> star_variants() {
  std::vector<StarVariant> variants = {{"scalar", Isa::baseline, &scalar::sum_stars},
                                       {"baseline", Isa::baseline, &baseline::sum_stars},
                                       {"avx2", Isa::avx2, &avx2::sum_stars},
                                       {"avx512", Isa::avx512, &avx512::sum_stars}};
  std::erase_if(variants, [](const StarVariant& variant) { return variant.needs > active_isa(); });
  return variants;
}

void compare_with_one_by_one(const Model& model, std::span<const Vec3> x) {
  const VertexColours colours = colour_vertices(model);
  IncrementalPotential potential(model, 1.0 / 60);
  std::vector<StepVertex> vertices;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    const Vec3& p = model.rest_positions[v];
    vertices.push_back({{p[0], p[1], p[2]}, v % 11 == 0 ? 0 : model.inverse_masses[v]});
  }
  const std::vector<Vec3> still(x.size(), Vec3::Zero());
  potential.begin(Step{1, 0, 1.0 / 60, model.rest_positions, still}, vertices);
  VertexStars stars(model, colours, potential.cloth());
  stars.begin();
  stars.place(x);
  const auto count = static_cast<Index>(colours.vertices.size());
  std::vector<StarSums> first;
  for (const StarVariant& variant : star_variants()) {
    std::vector<StarSums> sums(count);
    variant.sum(stars.task(), 0, count, sums.data());
    if (first.empty()) first = sums;
    EXPECT_EQ(std::memcmp(sums.data(), first.data(), sizeof(StarSums) * sums.size()), 0) << variant.name;
  }
  stars.renew_contacts(potential);
  VertexStars::Derivatives derivatives;
  for (Index i = 0; i < count; ++i) {
    if (!potential.is_free(colours.vertices[i])) continue;
    const VertexDerivatives one_by_one = potential.by_vertex(x, colours.vertices[i]);
    stars.differentiate(potential, x, i, first[i], derivatives);
    const VertexDerivatives& together = derivatives.all;
    const double size = one_by_one.hessian.norm();
    EXPECT_LT((together.hessian - one_by_one.hessian).norm(), 1e-12 * size) << i;
    EXPECT_LT((together.gradient - one_by_one.gradient).norm(), 1e-12 * size) << i;
  }
}

TEST(VertexStars, AddUpWhatTheElementsOfAVertexAreOneByOne) {
  const std::vector<IndexedMesh> meshes{make_ball(0.3, 0.1), moved(make_box({0.3, 0.2, 0.1}, 0.05), {1, 0, 0})};
  for (const double ratio : {0.0, 0.3, 0.499}) {
    Model model = make(meshes, neo_hookean(1e5, ratio));
    for (const double reach : {0.0, 1e-3, 0.05, 1.0})
      compare_with_one_by_one(model, jittered(model.rest_positions, reach, 7));
    std::vector<Vec3> flat = model.rest_positions, point = flat;
    for (Vec3& p : flat) p[2] = 0;
    for (Vec3& p : point) p = Vec3(1, 2, 3);
    compare_with_one_by_one(model, flat);
    compare_with_one_by_one(model, point);
  }
}

TEST(VertexStars, LeaveSpringsAndDampedElementsToThePotential) {
  const IndexedMesh box = make_box({0.3, 0.2, 0.1}, 0.1);
  for (const Material& material : {springs(1e-4, 1e-9), damped(neo_hookean(1e5, 0.4), 0.01)}) {
    const Model model = make(box, material);
    const VertexColours colours = colour_vertices(model);
    const IncrementalPotential potential(model, 1.0 / 60);
    EXPECT_EQ(VertexStars(model, colours, potential.cloth()).task().first_batches[colours.vertices.size()], 0);
    compare_with_one_by_one(model, jittered(model.rest_positions, 0.02, 3));
  }
}

struct ClothStarVariant {
  const char* name;
  Isa needs;
  void (*sum)(const ClothStarTask&, Index, ClothStarSums&);
  void (*measure)(const ClothStarTask&, Index, const double[3], double&);
};

std::vector<ClothStarVariant> cloth_star_variants() {
  std::vector<ClothStarVariant> variants = {
      {"scalar", Isa::baseline, &scalar::sum_cloth_star, &scalar::measure_cloth_star},
      {"baseline", Isa::baseline, &baseline::sum_cloth_star, &baseline::measure_cloth_star},
      {"avx2", Isa::avx2, &avx2::sum_cloth_star, &avx2::measure_cloth_star},
      {"avx512", Isa::avx512, &avx512::sum_cloth_star, &avx512::measure_cloth_star}};
  std::erase_if(variants, [](const ClothStarVariant& variant) { return variant.needs > active_isa(); });
  return variants;
}

/// Also that energies of the batched triangles change as those of the terms do.
void compare_cloth_kernels(const Model& model, std::span<const Vec3> start, std::span<const Vec3> x) {
  const VertexColours colours = colour_vertices(model);
  ClothTerms terms(model, 1.0 / 300);
  terms.begin(start);
  VertexStars stars(model, colours, terms);
  stars.begin();
  stars.place(x);
  const ClothStarTask task = stars.cloth().task();
  for (Index i = 0; i < std::ssize(colours.vertices); ++i) {
    const Index v = colours.vertices[i];
    const Vec3 at = x[v] + Vec3(0.01, -0.02, 0.005);
    std::vector<ClothStarSums> sums;
    std::vector<double> energies;
    for (const ClothStarVariant& variant : cloth_star_variants()) {
      variant.sum(task, i, sums.emplace_back());
      variant.measure(task, i, at.data(), energies.emplace_back());
      EXPECT_EQ(std::memcmp(&sums.back(), &sums.front(), sizeof(ClothStarSums)), 0) << variant.name;
      EXPECT_EQ(energies.back(), energies.front()) << variant.name;
    }
    VertexDerivatives all{Vec3::Zero(), Eigen::Matrix3d::Zero()}, quadratic = all, one_by_one = all;
    const double before = stars.cloth().add(x, i, all, quadratic);
    double expected_before = 0, expected = 0;
    for (const Index t : terms.terms_of(v)) {
      terms.add_by_vertex(x, t, v, one_by_one);
      expected_before += terms.energy_by_vertex(x, t, v, x[v]);
      expected += terms.energy_by_vertex(x, t, v, at);
    }
    const Vec3 moved = at - x[v];
    const double of_quadratic = quadratic.gradient.dot(moved) + 0.5 * moved.dot(quadratic.hessian * moved);
    const double size = one_by_one.hessian.norm();
    EXPECT_LT((all.hessian - one_by_one.hessian).norm(), 1e-12 * size) << i;
    EXPECT_LT((all.gradient - one_by_one.gradient).norm(), 1e-12 * size) << i;
    EXPECT_NEAR(stars.cloth().energy(x, i, at) - before + of_quadratic, expected - expected_before,
                1e-11 * (expected + expected_before));
  }
}

TEST(ClothStars, AddUpWhatTheClothOfAVertexIsOneByOneOnEveryInstructionSet) {
  const IndexedMesh sheet = make_cloth(0.6, 0.4, 0.1);
  IndexedMesh tube = moved(sheet, {0, 2, 0});
  for (Vec3& p : tube.positions) p = Vec3(std::cos(p[0]), p[1], std::sin(p[0]));
  for (ClothMaterial material : {cloth(), woven()}) {
    material.bending = 1e-3;
    for (const double damping : {0.0, 0.003}) {
      material.damping = damping;
      const Model model = make_sheets({sheet, tube}, material);
      const std::vector<Vec3>& rest = model.rest_positions;
      for (const double reach : {0.0, 1e-3, 0.05, 0.5})
        compare_cloth_kernels(model, jittered(rest, 0.02, 5), jittered(rest, reach, 7));
      std::vector<Vec3> flat = rest, line = rest, point = rest;
      for (Vec3& p : flat) p[2] = 0;
      for (Vec3& p : line) p[1] = p[2] = 0;
      for (Vec3& p : point) p = Vec3(1, 2, 3);
      for (const std::vector<Vec3>& x : {flat, line, point}) compare_cloth_kernels(model, rest, x);
    }
  }
}

/// A contact of vertices of one colour, which are all moved at the same time.
OffsetTerm contact_of(const Model& model, const VertexColours& colours, Index colour) {
  OffsetTerm term;
  term.count = 4;
  for (int i = 0; i < 4; ++i) term.vertices[i] = colours.vertices[colours.first[colour] + i];
  term.weights = {0.5, 0.5, -0.5, -0.5};
  term.normal = Vec3(0, 0, 1);
  term.stiffness = 1e7;
  term.origin = term.offset(model.rest_positions);
  term.target = 0.01;
  return term;
}

TEST(VertexStars, LowerTheEnergyOfContactsBetweenVerticesThatMoveTogether) {
  const Model model = make(make_box({0.4, 0.4, 0.4}, 0.1), neo_hookean(1e4, 0.3));
  const VertexColours colours = colour_vertices(model);
  std::vector<StepVertex> vertices;
  for (Index v = 0; v < model.mesh.vertex_count(); ++v) {
    const Vec3& p = model.rest_positions[v];
    vertices.push_back({{p[0], p[1], p[2]}, model.inverse_masses[v]});
  }
  const std::vector<Vec3> still(model.rest_positions.size(), Vec3::Zero());
  IncrementalPotential potential(model, 1.0 / 60);
  potential.begin(Step{1, 0, 1.0 / 60, model.rest_positions, still}, vertices);
  ASSERT_GE(colours.first[1] - colours.first[0], 4);
  // Between two planes that leave 2 mm.
  OffsetTerm other = contact_of(model, colours, 0);
  other.normal = -other.normal;
  other.target = -0.012;
  potential.set_contacts({contact_of(model, colours, 0), other});
  VertexStars stars(model, colours, potential.cloth());
  std::vector<Vec3> together = model.rest_positions, alone = together;
  stars.place(together);
  stars.renew_contacts(potential);
  for (Index i = 0; i < 4; ++i) {
    StarSums sums;
    stars.sum(i, i + 1, &sums);
    const Index v = colours.vertices[i];
    VertexStars::Derivatives derivatives;
    stars.differentiate(potential, model.rest_positions, i, sums, derivatives);
    const VertexDerivatives &bounded = derivatives.all, own = potential.by_vertex(model.rest_positions, v);
    together[v] -= bounded.hessian.llt().solve(bounded.gradient);
    alone[v] -= own.hessian.llt().solve(own.gradient);
  }
  const double before = potential.energy(model.rest_positions);
  EXPECT_LT(potential.energy(together), 0.1 * before);
  EXPECT_GT(potential.energy(alone), before);
}

}  // namespace
}  // namespace selvage
