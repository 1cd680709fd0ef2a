#include "simulation/vbd/vertex_stars.h"

#include "core/parallel.h"

#include <algorithm>

namespace selvage {

namespace {

/// Even permutations of a tetrahedron's vertices that begin with each: its orientation stays.
constexpr int kFrom[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 0, 1, 3}, {3, 0, 2, 1}};

std::vector<Index> own_rows_of(const VertexColours& colours) {
  std::vector<Index> rows;
  for (const Index v : colours.vertices) rows.push_back(kStarRow * v);
  return rows;
}

std::vector<const Material*> materials_of(const Model& model) {
  std::vector<const Material*> materials(model.mesh.element_count(), nullptr);
  for (const Body& body : model.bodies)
    if (body.material.kind == MaterialKind::kNeoHookean && !(body.material.damping > 0))
      std::fill_n(materials.begin() + body.first_element, body.element_count, &body.material);
  return materials;
}

}  // namespace

VertexStars::VertexStars(const Model& model, const VertexColours& colours, const ClothTerms& cloth)
    : colours_(colours),
      rows_(kStarRow * static_cast<std::size_t>(model.mesh.vertex_count()), 0.0),
      own_rows_(own_rows_of(colours)),
      cloth_(cloth, colours, rows_.data(), own_rows_.data()),
      contacts_(colours) {
  const std::vector<const Material*> materials = materials_of(model);
  first_batches_.push_back(0);
  first_others_.push_back(0);
  for (const Index v : colours.vertices) {
    isotropic_.push_back(0);
    std::vector<Index> batched;
    for (const Index e : model.mesh.vertex_elements(v)) (materials[e] != nullptr ? batched : others_).push_back(e);
    for (std::size_t i = 0; i < batched.size(); ++i) {
      const Index e = batched[i];
      if (i % kStarBatch == 0) add_batch(v);
      StarBatch& batch = batches_.back();
      const std::size_t place = i % kStarBatch;
      const auto& element = model.mesh.elements()[e];
      const auto k = std::find(element.begin(), element.end(), v) - element.begin();
      VertexTuple<4> own;
      for (int j = 0; j < 4; ++j) own[j] = element[kFrom[k][j]];
      const RestSimplex<3> rest = rest_tetrahedron(own, model.rest_positions);
      const auto [mu, lambda] = lame_parameters(materials[e]->youngs_modulus, materials[e]->poisson_ratio);
      const Eigen::Vector3d b = rest.by_vertex(0), pull = rest.inverse_edges * b;
      for (int j = 0; j < 3; ++j) {
        batch.rows[j][place] = kStarRow * own[j + 1];
        batch.weights[j][place] = rest.size * mu * pull[j];
      }
      batch.inverse_determinant[place] = 1 / (6 * rest.size);
      batch.bulk[place] = rest.size * (lambda + mu);
      batch.shear[place] = rest.size * mu;
      isotropic_.back() += rest.size * mu * b.squaredNorm();
    }
    first_batches_.push_back(std::ssize(batches_));
    first_others_.push_back(std::ssize(others_));
  }
}

/// Of elements that are points: they add zero, whatever the positions.
void VertexStars::add_batch(Index vertex) {
  StarBatch& batch = batches_.emplace_back();
  for (Index(&rows)[kStarBatch] : batch.rows) std::fill_n(rows, kStarBatch, kStarRow * vertex);
}

void VertexStars::place(Index vertex, const Vec3& x) {
  for (int i = 0; i < 3; ++i) rows_[kStarRow * static_cast<std::size_t>(vertex) + i] = x[i];
}

void VertexStars::place(std::span<const Vec3> x) {
  parallel_for(std::ssize(x), kGrain, [&](std::int64_t v) { place(static_cast<Index>(v), x[v]); });
}

void VertexStars::sum_best(const StarTask& task, Index first, Index last, StarSums* sums) {
  SELVAGE_DISPATCH(sum_stars, task, first, last, sums);
}

void VertexStars::differentiate(const IncrementalPotential& potential, std::span<const Vec3> x, Index i,
                                const StarSums& sums, Derivatives& derivatives) const {
  const Index v = colours_.vertices[i];
  VertexDerivatives& sum = derivatives.all;
  sum = potential.inertia_by_vertex(x, v);
  sum.gradient += Eigen::Map<const Eigen::Vector3d>(sums.gradient);
  const auto& [xx, yy, zz, xy, xz, yz] = sums.hessian;
  Eigen::Matrix3d hessian;
  hessian << xx + isotropic_[i], xy, xz, xy, yy + isotropic_[i], yz, xz, yz, zz + isotropic_[i];
  sum.hessian += hessian;
  for (std::int64_t n = first_others_[i]; n < first_others_[i + 1]; ++n)
    potential.elements().add_by_vertex(x, others_[n], v, sum);
  derivatives.quadratic = sum;
  derivatives.cloth_energy = cloth_.add(x, i, sum, derivatives.quadratic);
  contacts_.add(x, i, sum, derivatives.contacts);
}

double VertexStars::energy(std::span<const Vec3> x, Index i, const Vec3& move, const Derivatives& derivatives) const {
  return cloth_.energy(x, i, x[colours_.vertices[i]] + move) + VertexContacts::energy(derivatives.contacts, move);
}

}  // namespace selvage
