#include "simulation/implicit/incremental_potential.h"

#include "core/parallel.h"
#include "selvage/core/error.h"
#include "simulation/elements/ordered_sum.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr std::int64_t kEnergyGrain = 64, kTermGrain = 256;

/// The model, where all its bodies can be minimised.
const Model& checked(const Model& model) {
  for (const Body& body : model.bodies) {
    const Material& m = body.material;
    if (m.kind == MaterialKind::kMassSpring && !(m.edge_compliance > 0 && m.volume_compliance > 0))
      throw Error(fmt::format("body '{}'", body.name), "is rigid: a compliance is 0",
                  "give edge_compliance and volume_compliance above 0, or use the solver xpbd");
  }
  return model;
}

}  // namespace

IncrementalPotential::IncrementalPotential(const Model& model, double time_step)
    : model_(checked(model)),
      time_step_(time_step),
      elements_(model, time_step),
      rest_stiffness_(model.mesh.vertex_count(), 0.0),
      cloth_(model, time_step) {
  for (Index e = 0; e < elements_.count(); ++e)
    for (int k = 0; k < 4; ++k) rest_stiffness_[model.mesh.elements()[e][k]] += elements_.rest_stiffness(e, k);
  for (const Body& body : model.bodies)
    if (body.material.kind == MaterialKind::kMassSpring) add_springs(body);
  cloth_derivatives_.resize(cloth_.count());
  for (Index t = 0; t < cloth_.count(); ++t) {
    const StencilHessian<4> hessian = cloth_.derivatives(t, model.rest_positions, false).hessian;
    const auto vertices = cloth_.vertices_of(t);
    for (std::size_t k = 0; k < vertices.size(); ++k)
      rest_stiffness_[vertices[k]] += hessian.block<3, 3>(3 * k, 3 * k).trace() / 3;
  }
  masses_.resize(vertex_count());
  targets_.resize(vertex_count());
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
  elements_.begin(step.positions);
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

double IncrementalPotential::energy(std::span<const Vec3> x) const {
  const double inertia =
      ordered_sum(vertex_count(), [&](std::int64_t v) { return masses_[v] / 2 * (x[v] - targets_[v]).squaredNorm(); });
  const double elastic = elements_.energy(x);
  const double cloth =
      ordered_sum(cloth_.count(), [&](std::int64_t t) { return cloth_.energy(static_cast<Index>(t), x); });
  return inertia + elastic + cloth +
         ordered_sum(std::ssize(terms_), [&](std::int64_t t) { return terms_[t].energy(terms_[t].offset(x)); });
}

void IncrementalPotential::find_gradient(std::span<const Vec3> x, Eigen::VectorXd& gradient) const {
  std::vector<ElementGradient> of_elements;
  elements_.find_gradients(x, of_elements);
  std::vector<StencilGradient<4>> of_cloth(cloth_.count());
  parallel_for(std::ssize(of_cloth), kEnergyGrain,
               [&](std::int64_t t) { of_cloth[t] = cloth_.gradient(static_cast<Index>(t), x); });
  std::vector<Eigen::Vector3d> of_terms(terms_.size());
  parallel_for(std::ssize(of_terms), kEnergyGrain,
               [&](std::int64_t t) { of_terms[t] = terms_[t].gradient(terms_[t].offset(x)); });
  gradient.setZero(3 * Eigen::Index{vertex_count()});
  parallel_for(vertex_count(), kTermGrain, [&](std::int64_t i) {
    const auto v = static_cast<Index>(i);
    if (!is_free(v)) return;
    Eigen::Vector3d sum = masses_[v] * (x[v] - targets_[v]);
    for (const Index e : model_.mesh.vertex_elements(v)) {
      const auto& element = model_.mesh.elements()[e];
      sum += gradient_of(of_elements[e].of_vertex,
                         static_cast<int>(std::find(element.begin(), element.end(), v) - element.begin()));
    }
    for (const Index t : cloth_.terms_of(v)) {
      const auto vertices = cloth_.vertices_of(t);
      sum += of_cloth[t].col(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
    }
    for (const Index t : terms_of(v)) sum += terms_[t].weights[terms_[t].place_of(v)] * of_terms[t];
    gradient.segment<3>(3 * i) = sum;
  });
}

VertexDerivatives IncrementalPotential::inertia_by_vertex(std::span<const Vec3> x, Index v) const {
  return {masses_[v] * (x[v] - targets_[v]), masses_[v] * Eigen::Matrix3d::Identity()};
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
  for (const Index e : model_.mesh.vertex_elements(v)) elements_.add_by_vertex(x, e, v, sum);
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
