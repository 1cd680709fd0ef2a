// The elements of a vertex side by side, against the same one by one, on every instruction set.
#include "simulation/vbd/vertex_stars.h"
#include "core/isa.h"
#include "simulation/bodies.h"
#include "simulation/vbd/vertex_colours.h"

namespace selvage {

namespace scalar {
void sum_stars(const StarTask&, Index first, Index last, StarSums* sums);
}

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
  VertexStars stars(model, colours);
  stars.place(x);
  const auto count = static_cast<Index>(colours.vertices.size());
  std::vector<StarSums> first;
  for (const StarVariant& variant : star_variants()) {
    std::vector<StarSums> sums(count);
    variant.sum(stars.task(), 0, count, sums.data());
    if (first.empty()) first = sums;
    EXPECT_EQ(std::memcmp(sums.data(), first.data(), sizeof(StarSums) * sums.size()), 0) << variant.name;
  }
  for (Index i = 0; i < count; ++i) {
    VertexDerivatives quadratic;
    const VertexDerivatives one_by_one = potential.by_vertex(x, colours.vertices[i]),
                            together = stars.derivatives(potential, x, i, first[i], quadratic);
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
    EXPECT_EQ(VertexStars(model, colours).task().first_batches[colours.vertices.size()], 0);
    compare_with_one_by_one(model, jittered(model.rest_positions, 0.02, 3));
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
  VertexStars stars(model, colours);
  std::vector<Vec3> together = model.rest_positions, alone = together;
  stars.place(together);
  for (Index i = 0; i < 4; ++i) {
    StarSums sums;
    stars.sum(i, i + 1, &sums);
    const Index v = colours.vertices[i];
    VertexDerivatives quadratic;
    const VertexDerivatives bounded = stars.derivatives(potential, model.rest_positions, i, sums, quadratic),
                            own = potential.by_vertex(model.rest_positions, v);
    together[v] -= bounded.hessian.llt().solve(bounded.gradient);
    alone[v] -= own.hessian.llt().solve(own.gradient);
  }
  const double before = potential.energy(model.rest_positions);
  EXPECT_LT(potential.energy(together), 0.1 * before);
  EXPECT_GT(potential.energy(alone), before);
}

}  // namespace
}  // namespace selvage
