#include "simulation/elements/element_terms.h"

#include "core/parallel.h"
#include "elasticity/deformation_gradient.h"
#include "simulation/elements/ordered_sum.h"
#include "simulation/elements/rows.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr std::int64_t kBatchGrain = 16, kElementGrain = 64;

double trace_by_vertex(const NeoHookean& material, const Eigen::Vector3d& b) {
  return (3 * material.mu + material.lambda + material.mu) * b.squaredNorm();
}
double trace_by_vertex(const VolumeSpring& material, const Eigen::Vector3d& b) {
  return material.stiffness * b.squaredNorm();
}

}  // namespace

ElementTerms::ElementTerms(const Model& model, double time_step) : model_(model) {
  bool damped = false;
  for (const Body& body : model.bodies) {
    const Material& m = body.material;
    const bool springs = m.kind == MaterialKind::kMassSpring;
    for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
      const RestSimplex<3> rest = rest_tetrahedron(model_.mesh.elements()[e], model_.rest_positions);
      if (springs)
        elements_.push_back({rest, VolumeSpring{rest.size / m.volume_compliance}});
      else
        elements_.push_back({rest, NeoHookean::of(m.youngs_modulus, m.poisson_ratio)});
      damping_.push_back(m.damping / time_step);
      if (springs) others_.push_back(e);
    }
    if (!springs) add_batches(body);
    damped |= m.damping > 0;
  }
  if (damped) start_gradients_.resize(elements_.size());
}

/// The last batch may have empty places: a record of its own, so that no two threads write to one.
void ElementTerms::add_batches(const Body& body) {
  for (Index i = 0; i < body.element_count; ++i) {
    const int lane = i % kSolidBatch;
    if (lane == 0) std::fill_n(batches_.emplace_back().elements, kSolidBatch, model_.mesh.element_count() + spare_);
    SolidBatch& batch = batches_.back();
    const Index e = body.first_element + i;
    const RestSimplex<3>& rest = elements_[e].rest;
    const auto& material = std::get<NeoHookean>(elements_[e].material);
    batch.elements[lane] = e;
    for (int k = 0; k < 4; ++k) batch.rows[k][lane] = kElementRow * model_.mesh.elements()[e][k];
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) batch.inverse_edges[k][j][lane] = rest.inverse_edges(k, j);
    batch.inverse_determinant[lane] = 1 / (6 * rest.size);
    batch.mu[lane] = rest.size * material.mu;
    batch.bulk[lane] = rest.size * (material.lambda + material.mu);
    batch.damping_mu[lane] = damping_[e] * rest.size * material.mu;
    batch.damping_bulk[lane] = damping_[e] * rest.size * material.lambda;
  }
  ++spare_;
}

void ElementTerms::begin(std::span<const Vec3> positions) {
  if (!is_damped()) return;
  parallel_for(count(), kElementGrain,
               [&](std::int64_t e) { start_gradients_[e] = deformation(static_cast<Index>(e), positions); });
  parallel_for(std::ssize(batches_), kBatchGrain, [&](std::int64_t n) {
    SolidBatch& batch = batches_[n];
    for (int lane = 0; lane < kSolidBatch; ++lane) {
      if (batch.elements[lane] >= count()) continue;
      const Eigen::Matrix3d& f = start_gradients_[batch.elements[lane]];
      const Eigen::Matrix3d squared = f.transpose() * f;
      const double entries[] = {squared(0, 0), squared(1, 1), squared(2, 2),
                                squared(1, 2), squared(0, 2), squared(0, 1)};
      for (int i = 0; i < 6; ++i) batch.squared_start[i][lane] = entries[i];
    }
  });
}

/// Calls visit with each energy density of an element.
template <typename Visit>
void ElementTerms::visit_densities(Index e, const Visit& visit) const {
  const Element& element = elements_[e];
  std::visit(visit, element.material);
  const double damping = damping_[e];
  if (!(damping > 0)) return;
  const Eigen::Matrix3d& start = start_gradients_[e];
  if (const auto* solid = std::get_if<NeoHookean>(&element.material))
    visit(StrainDamping<3>{damping * solid->mu, damping * solid->lambda, start.transpose() * start});
  else
    visit(VolumeSpring{damping * std::get<VolumeSpring>(element.material).stiffness, start.determinant()});
}

double ElementTerms::energy(std::span<const Vec3> x) const {
  const std::vector<double> rows = rows_of(x);
  std::vector<double> energies(record_count());
  parallel_ranges(std::ssize(batches_), kBatchGrain, [&](std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(measure_elements, task(rows), first, last, energies.data());
  });
  parallel_for(std::ssize(others_), kElementGrain, [&](std::int64_t i) {
    const Eigen::Matrix3d f = deformation(others_[i], x);
    double sum = 0;
    visit_densities(others_[i], [&](const auto& density) { sum += density.energy_density(f); });
    energies[others_[i]] = elements_[others_[i]].rest.size * sum;
  });
  return ordered_sum(count(), [&](std::int64_t e) { return energies[e]; });
}

void ElementTerms::find_gradients(std::span<const Vec3> x, std::vector<ElementGradient>& gradients) const {
  const std::vector<double> rows = rows_of(x);
  gradients.resize(record_count());
  parallel_ranges(std::ssize(batches_), kBatchGrain, [&](std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(pull_elements, task(rows), first, last, gradients.data());
  });
  parallel_for(std::ssize(others_), kElementGrain, [&](std::int64_t i) {
    const Index e = others_[i];
    const Eigen::Matrix3d f = deformation(e, x);
    Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
    visit_densities(e, [&](const auto& density) { stress += density.first_piola(f); });
    const StencilGradient<4> gradient = elements_[e].rest.gradient_of(stress);
    for (int k = 0; k < 3; ++k) Eigen::Map<Eigen::Vector3d>(gradients[e].of_vertex[k]) = gradient.col(k + 1);
  });
}

ElementDerivatives ElementTerms::derivatives_of_one(Index e, std::span<const Vec3> x, bool is_exact) const {
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = deformation(e, x);
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  DeformationHessian<3> hessian = DeformationHessian<3>::Zero();
  visit_densities(e, [&](const auto& density) {
    stress += density.first_piola(f);
    hessian += is_exact ? density.hessian(f) : density.positive_hessian(f);
  });
  const StencilGradient<4> gradient = rest.gradient_of(stress);
  const StencilHessian<4> blocks = rest.hessian_of(hessian);
  ElementDerivatives result{};
  for (int k = 0, place = 0; k < 4; ++k)
    for (int l = k + 1; l < 4; ++l)
      Eigen::Map<Eigen::Matrix3d>(result.blocks[place++]) = blocks.block<3, 3>(3 * k, 3 * l);
  for (int k = 0; k < 3; ++k) Eigen::Map<Eigen::Vector3d>(result.gradient[k]) = gradient.col(k + 1);
  return result;
}

void ElementTerms::differentiate(std::span<const Vec3> x, bool is_exact,
                                 std::vector<ElementDerivatives>& derivatives) const {
  const std::vector<double> rows = rows_of(x);
  derivatives.resize(record_count());
  parallel_ranges(std::ssize(batches_), kBatchGrain, [&](std::int64_t first, std::int64_t last) {
    SELVAGE_DISPATCH(differentiate_elements, task(rows), is_exact, first, last, derivatives.data());
  });
  parallel_for(std::ssize(others_), kElementGrain,
               [&](std::int64_t i) { derivatives[others_[i]] = derivatives_of_one(others_[i], x, is_exact); });
}

void ElementTerms::add_by_vertex(std::span<const Vec3> x, Index e, Index v, VertexDerivatives& sum) const {
  const auto& element = model_.mesh.elements()[e];
  const auto k = static_cast<int>(std::find(element.begin(), element.end(), v) - element.begin());
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = deformation(e, x);
  const Eigen::Vector3d b = rest.by_vertex(k);
  visit_densities(e, [&](const auto& density) {
    const VertexDerivatives own = density.by_vertex(f, b);
    sum.gradient += rest.size * own.gradient;
    sum.hessian += rest.size * own.hessian;
  });
}

double ElementTerms::rest_stiffness(Index e, int k) const {
  const RestSimplex<3>& rest = elements_[e].rest;
  return rest.size / 3 *
         std::visit([&](const auto& material) { return trace_by_vertex(material, rest.by_vertex(k)); },
                    elements_[e].material);
}

}  // namespace selvage
