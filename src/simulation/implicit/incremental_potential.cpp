#include "simulation/implicit/incremental_potential.h"

#include "core/parallel.h"
#include "selvage/core/error.h"
#include "simulation/implicit/ordered_sum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr std::int64_t kEnergyGrain = 64, kTermGrain = 256;

double trace_by_vertex(const NeoHookean& material, const Eigen::Vector3d& b) {
  return (3 * material.mu + material.lambda + material.mu) * b.squaredNorm();
}
double trace_by_vertex(const VolumeSpring& material, const Eigen::Vector3d& b) {
  return material.stiffness * b.squaredNorm();
}

}  // namespace

IncrementalPotential::IncrementalPotential(const Model& model, double time_step)
    : model_(model), time_step_(time_step), rest_stiffness_(model.mesh.vertex_count(), 0.0), cloth_(model, time_step) {
  bool damped = false;
  for (const Body& body : model.bodies) {
    add_body(body);
    damped |= body.material.damping > 0;
  }
  cloth_derivatives_.resize(cloth_.count());
  for (Index t = 0; t < cloth_.count(); ++t) {
    const StencilHessian<4> hessian = cloth_.derivatives(t, model.rest_positions, false).hessian;
    const auto vertices = cloth_.vertices_of(t);
    for (std::size_t k = 0; k < vertices.size(); ++k)
      rest_stiffness_[vertices[k]] += hessian.block<3, 3>(3 * k, 3 * k).trace() / 3;
  }
  if (damped) start_gradients_.resize(elements_.size());
  element_derivatives_.resize(elements_.size());
  masses_.resize(vertex_count());
  targets_.resize(vertex_count());
}

void IncrementalPotential::add_body(const Body& body) {
  const Material& m = body.material;
  const bool springs = m.kind == MaterialKind::kMassSpring;
  if (springs && !(m.edge_compliance > 0 && m.volume_compliance > 0))
    throw Error(fmt::format("body '{}'", body.name), "is rigid: a compliance is 0",
                "give edge_compliance and volume_compliance above 0, or use the solver xpbd");
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e) {
    const RestSimplex<3> rest = rest_tetrahedron(model_.mesh.elements()[e], model_.rest_positions);
    if (springs)
      elements_.push_back({rest, VolumeSpring{rest.size / m.volume_compliance}});
    else
      elements_.push_back({rest, NeoHookean::of(m.youngs_modulus, m.poisson_ratio)});
    element_damping_.push_back(m.damping / time_step_);
    for (int k = 0; k < 4; ++k)
      rest_stiffness_[model_.mesh.elements()[e][k]] +=
          rest.size / 3 *
          std::visit([&](const auto& material) { return trace_by_vertex(material, rest.by_vertex(k)); },
                     elements_.back().material);
  }
  if (springs) add_springs(body);
}

void IncrementalPotential::add_springs(const Body& body) {
  std::vector<VertexTuple<2>> edges;
  for (Index e = body.first_element; e < body.first_element + body.element_count; ++e)
    for (const Index a : model_.mesh.elements()[e])
      for (const Index b : model_.mesh.elements()[e])
        if (a < b) edges.push_back({a, b});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [a, b] : edges) {
    OffsetTerm spring;
    spring.count = 2;
    spring.vertices = {a, b};
    spring.weights = {-1, 1};
    spring.stiffness = 1 / body.material.edge_compliance;
    spring.length = (model_.rest_positions[b] - model_.rest_positions[a]).norm();
    springs_.push_back(spring);
    spring_damping_.push_back(body.material.damping / time_step_);
    for (const Index v : {a, b}) rest_stiffness_[v] += spring.stiffness / 3;
  }
}

double IncrementalPotential::stiffness(Index v) const {
  return is_free(v) ? masses_[v] + rest_stiffness_[v] : std::numeric_limits<double>::infinity();
}

void IncrementalPotential::begin(const Step& step, std::span<const StepVertex> vertices) {
  for (Index v = 0; v < vertex_count(); ++v) {
    const double inverse_mass = vertices[v].inverse_mass;
    masses_[v] = inverse_mass > 0 ? 1 / (inverse_mass * time_step_ * time_step_) : 0;
    targets_[v] = Eigen::Map<const Eigen::Vector3d>(vertices[v].position);
  }
  parallel_for(std::ssize(start_gradients_), kEnergyGrain, [&](std::int64_t e) {
    start_gradients_[e] = elements_[e].rest.deformation(corners(static_cast<Index>(e), step.positions));
  });
  cloth_.begin(step.positions);
  terms_ = springs_;
  for (std::size_t s = 0; s < springs_.size(); ++s) {
    if (!(spring_damping_[s] > 0)) continue;
    OffsetTerm damper = springs_[s];
    damper.stiffness *= spring_damping_[s];
    damper.length = damper.offset(step.positions).norm();
    terms_.push_back(damper);
  }
  fixed_terms_ = terms_.size();
  join_terms();
}

void IncrementalPotential::set_contacts(std::vector<OffsetTerm> contacts) {
  const bool has_pairs = std::any_of(contacts.begin(), contacts.end(), [](const auto& term) { return term.count > 1; });
  pattern_is_old_ |= has_pairs || pattern_has_pairs_;
  pattern_has_pairs_ = has_pairs;
  terms_.resize(fixed_terms_);
  terms_.insert(terms_.end(), contacts.begin(), contacts.end());
  join_terms();
}

/// Lists the terms of each vertex.
void IncrementalPotential::join_terms() {
  term_derivatives_.resize(terms_.size());
  term_first_.assign(vertex_count() + 1, 0);
  for (const OffsetTerm& term : terms_)
    for (const Index v : term.vertex_span()) ++term_first_[v + 1];
  for (Index v = 0; v < vertex_count(); ++v) term_first_[v + 1] += term_first_[v];
  term_of_vertex_.resize(term_first_.back());
  std::vector<std::size_t> next(term_first_.begin(), term_first_.end() - 1);
  for (std::size_t t = 0; t < terms_.size(); ++t)
    for (const Index v : terms_[t].vertex_span()) term_of_vertex_[next[v]++] = static_cast<Index>(t);
}

void IncrementalPotential::renew_friction(std::span<const Vec3> x, bool first) {
  for (std::size_t t = fixed_terms_; t < terms_.size(); ++t) {
    OffsetTerm& term = terms_[t];
    const Vec3 u = term.offset(x);
    double most = std::numeric_limits<double>::infinity();
    if (first) {
      double mobility = 0;
      for (int i = 0; i < term.count; ++i)
        if (is_free(term.vertices[i])) mobility += term.weights[i] * term.weights[i] / masses_[term.vertices[i]];
      if (mobility > 0) most = std::max(term.target - term.normal.dot(u), 0.0) / mobility;
    }
    term.renew_friction(u, most);
  }
}

StencilPositions<4> IncrementalPotential::corners(Index e, std::span<const Vec3> x) const {
  return gather(model_.mesh.elements()[e], x);
}

/// Calls visit with each energy density of an element.
template <typename Visit>
void IncrementalPotential::visit_densities(Index e, const Visit& visit) const {
  const Element& element = elements_[e];
  std::visit(visit, element.material);
  const double damping = element_damping_[e];
  if (!(damping > 0)) return;
  const Eigen::Matrix3d& start = start_gradients_[e];
  if (const auto* solid = std::get_if<NeoHookean>(&element.material))
    visit(StrainDamping<3>{damping * solid->mu, damping * solid->lambda, start.transpose() * start});
  else
    visit(VolumeSpring{damping * std::get<VolumeSpring>(element.material).stiffness, start.determinant()});
}

double IncrementalPotential::element_energy(Index e, std::span<const Vec3> x) const {
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = rest.deformation(corners(e, x));
  double sum = 0;
  visit_densities(e, [&](const auto& density) { sum += density.energy_density(f); });
  return rest.size * sum;
}

StencilGradient<4> IncrementalPotential::element_gradient(Index e, std::span<const Vec3> x) const {
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = rest.deformation(corners(e, x));
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  visit_densities(e, [&](const auto& density) { stress += density.first_piola(f); });
  return rest.gradient_of(stress);
}

IncrementalPotential::ElementDerivatives IncrementalPotential::element_derivatives(Index e, std::span<const Vec3> x,
                                                                                   bool exact) const {
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = rest.deformation(corners(e, x));
  Eigen::Matrix3d stress = Eigen::Matrix3d::Zero();
  DeformationHessian<3> hessian = DeformationHessian<3>::Zero();
  visit_densities(e, [&](const auto& density) {
    stress += density.first_piola(f);
    hessian += exact ? density.hessian(f) : density.positive_hessian(f);
  });
  return {rest.gradient_of(stress), rest.hessian_of(hessian)};
}

double IncrementalPotential::energy(std::span<const Vec3> x) const {
  const double inertia =
      ordered_sum(vertex_count(), [&](std::int64_t v) { return masses_[v] / 2 * (x[v] - targets_[v]).squaredNorm(); });
  const double elastic =
      ordered_sum(std::ssize(elements_), [&](std::int64_t e) { return element_energy(static_cast<Index>(e), x); });
  const double cloth =
      ordered_sum(cloth_.count(), [&](std::int64_t t) { return cloth_.energy(static_cast<Index>(t), x); });
  return inertia + elastic + cloth +
         ordered_sum(std::ssize(terms_), [&](std::int64_t t) { return terms_[t].energy(terms_[t].offset(x)); });
}

void IncrementalPotential::find_gradient(std::span<const Vec3> x, Eigen::VectorXd& gradient) const {
  std::vector<StencilGradient<4>> of_elements(elements_.size());
  parallel_for(std::ssize(elements_), kEnergyGrain,
               [&](std::int64_t e) { of_elements[e] = element_gradient(static_cast<Index>(e), x); });
  std::vector<StencilGradient<4>> of_cloth(cloth_.count());
  parallel_for(std::ssize(of_cloth), kEnergyGrain,
               [&](std::int64_t t) { of_cloth[t] = cloth_.gradient(static_cast<Index>(t), x); });
  gradient.setZero(3 * Eigen::Index{vertex_count()});
  parallel_for(vertex_count(), kTermGrain, [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    if (!is_free(v)) return;
    Eigen::Vector3d sum = masses_[v] * (x[v] - targets_[v]);
    for (const Index e : model_.mesh.vertex_elements(v)) {
      const auto& element = model_.mesh.elements()[e];
      sum += of_elements[e].col(std::find(element.begin(), element.end(), v) - element.begin());
    }
    for (const Index t : cloth_.terms_of(v)) {
      const auto vertices = cloth_.vertices_of(t);
      sum += of_cloth[t].col(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
    }
    for (const Index t : terms_of(v)) {
      const OffsetTerm& term = terms_[t];
      sum += term.weights[term.place_of(v)] * term.derivatives(term.offset(x)).gradient;
    }
    gradient.segment<3>(3 * i) = sum;
  });
}

void IncrementalPotential::renew_pattern(BlockMatrix& matrix) {
  std::vector<std::span<const Index>> groups;
  for (const OffsetTerm& term : terms_) groups.push_back(term.vertex_span());
  for (Index t = 0; t < cloth_.count(); ++t) groups.push_back(cloth_.vertices_of(t));
  matrix = make_block_matrix(vertex_count(), model_.mesh.elements(), groups);
  element_blocks_.resize(elements_.size());
  parallel_for(std::ssize(elements_), kEnergyGrain, [&](std::int64_t e) {
    const auto& element = model_.mesh.elements()[e];
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) element_blocks_[e][4 * i + j] = matrix.find(element[i], element[j]);
  });
  pattern_is_old_ = false;
}

bool IncrementalPotential::assemble(std::span<const Vec3> x, bool exact, Eigen::VectorXd& gradient,
                                    BlockMatrix& matrix) {
  const bool renews = pattern_is_old_ || matrix.first.empty();
  if (renews) renew_pattern(matrix);
  parallel_for(std::ssize(elements_), kEnergyGrain,
               [&](std::int64_t e) { element_derivatives_[e] = element_derivatives(static_cast<Index>(e), x, exact); });
  parallel_for(std::ssize(terms_), kTermGrain,
               [&](std::int64_t t) { term_derivatives_[t] = terms_[t].derivatives(terms_[t].offset(x)); });
  parallel_for(std::ssize(cloth_derivatives_), kEnergyGrain,
               [&](std::int64_t t) { cloth_derivatives_[t] = cloth_.derivatives(static_cast<Index>(t), x, exact); });
  gradient.setZero(3 * Eigen::Index{vertex_count()});
  parallel_for(vertex_count(), kTermGrain, [&](std::int64_t row) {
    const auto v = static_cast<Index>(row);
    for (std::int64_t i = matrix.first[v]; i < matrix.first[v + 1]; ++i) matrix.blocks[i].setZero();
    Eigen::Matrix3d& diagonal = matrix.blocks[matrix.find(v, v)];
    if (!is_free(v)) {
      diagonal.setIdentity();
      return;
    }
    Eigen::Vector3d sum = masses_[v] * (x[v] - targets_[v]);
    diagonal = masses_[v] * Eigen::Matrix3d::Identity();
    for (const Index e : model_.mesh.vertex_elements(v)) {
      const auto& element = model_.mesh.elements()[e];
      const auto i = std::find(element.begin(), element.end(), v) - element.begin();
      sum += element_derivatives_[e].gradient.col(i);
      for (int j = 0; j < 4; ++j)
        if (is_free(element[j]))
          matrix.blocks[element_blocks_[e][4 * i + j]] += element_derivatives_[e].hessian.block<3, 3>(3 * i, 3 * j);
    }
    add_cloth_row(v, matrix, sum);
    for (const Index t : terms_of(v)) {
      const OffsetTerm& term = terms_[t];
      const int i = term.place_of(v);
      sum += term.weights[i] * term_derivatives_[t].gradient;
      for (int j = 0; j < term.count; ++j)
        if (is_free(term.vertices[j]))
          matrix.blocks[matrix.find(v, term.vertices[j])] +=
              term.weights[i] * term.weights[j] * term_derivatives_[t].hessian;
    }
    gradient.segment<3>(3 * row) = sum;
  });
  return renews;
}

/// What cloth adds to the row of a free vertex.
void IncrementalPotential::add_cloth_row(Index v, BlockMatrix& matrix, Eigen::Vector3d& sum) const {
  for (const Index t : cloth_.terms_of(v)) {
    const auto vertices = cloth_.vertices_of(t);
    const auto i = std::find(vertices.begin(), vertices.end(), v) - vertices.begin();
    sum += cloth_derivatives_[t].gradient.col(i);
    for (std::size_t j = 0; j < vertices.size(); ++j)
      if (is_free(vertices[j]))
        matrix.blocks[matrix.find(v, vertices[j])] += cloth_derivatives_[t].hessian.block<3, 3>(3 * i, 3 * j);
  }
}

VertexDerivatives IncrementalPotential::inertia_by_vertex(std::span<const Vec3> x, Index v) const {
  return {masses_[v] * (x[v] - targets_[v]), masses_[v] * Eigen::Matrix3d::Identity()};
}

void IncrementalPotential::add_element_by_vertex(std::span<const Vec3> x, Index e, Index v,
                                                 VertexDerivatives& sum) const {
  const auto& element = model_.mesh.elements()[e];
  const auto k = static_cast<int>(std::find(element.begin(), element.end(), v) - element.begin());
  const RestSimplex<3>& rest = elements_[e].rest;
  const Eigen::Matrix3d f = rest.deformation(corners(e, x));
  const Eigen::Vector3d b = rest.by_vertex(k);
  visit_densities(e, [&](const auto& density) {
    const VertexDerivatives own = density.by_vertex(f, b);
    sum.gradient += rest.size * own.gradient;
    sum.hessian += rest.size * own.hessian;
  });
}

void IncrementalPotential::add_terms_by_vertex(std::span<const Vec3> x, Index v, VertexDerivatives& sum) const {
  for (const Index t : terms_of(v)) {
    const OffsetTerm& term = terms_[t];
    const double weight = term.weights[term.place_of(v)];
    const OffsetTerm::Derivatives own = term.derivatives(term.offset(x));
    sum.gradient += weight * own.gradient;
    sum.hessian += weight * weight * own.hessian;
  }
}

VertexDerivatives IncrementalPotential::by_vertex(std::span<const Vec3> x, Index v) const {
  VertexDerivatives sum = inertia_by_vertex(x, v);
  for (const Index e : model_.mesh.vertex_elements(v)) add_element_by_vertex(x, e, v, sum);
  for (const Index t : cloth_.terms_of(v)) cloth_.add_by_vertex(x, t, v, sum);
  add_terms_by_vertex(x, v, sum);
  return sum;
}

double residual_of(const IncrementalPotential& potential, std::span<const Vec3> x) {
  Eigen::VectorXd gradient;
  potential.find_gradient(x, gradient);
  double largest = 0;
  for (Index v = 0; v < potential.vertex_count(); ++v)
    if (potential.is_free(v))
      largest = std::max(largest, gradient.segment<3>(3 * Eigen::Index{v}).norm() / potential.inertia(v));
  return largest;
}

}  // namespace selvage
