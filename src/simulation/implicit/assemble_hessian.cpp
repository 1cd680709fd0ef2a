// The Hessian of an IncrementalPotential: blocks of pairs of vertices that share elements, then rows.
#include "core/parallel.h"
#include "simulation/implicit/incremental_potential.h"

#include <algorithm>

namespace selvage {

namespace {

constexpr std::int64_t kEdgeRowGrain = 64, kHessianRowGrain = 128, kPlaceGrain = 1024;

}  // namespace

void IncrementalPotential::find_fixed_pattern() {
  std::vector<std::span<const Index>> groups;
  for (const OffsetTerm& spring : springs_) groups.push_back(spring.vertex_span());
  for (Index t = 0; t < cloth_.count(); ++t) groups.push_back(cloth_.vertices_of(t));
  fixed_pattern_ = make_pattern(vertex_count(), model_.mesh.elements(), groups);
  edges_ = list_element_edges(model_.mesh);
  edge_blocks_.resize(edges_.edge_count());
}

void IncrementalPotential::renew_pattern(BlockMatrix& matrix) {
  if (fixed_pattern_.first.empty()) find_fixed_pattern();
  std::vector<std::span<const Index>> groups;
  for (const OffsetTerm& contact : std::span(terms_).subspan(fixed_terms_)) groups.push_back(contact.vertex_span());
  extend_pattern(fixed_pattern_, groups, matrix);
  std::vector<std::uint8_t> is_of_edge(matrix.blocks.size(), 0);
  parallel_for(vertex_count(), kEdgeRowGrain, [&](std::int64_t row) {
    const auto v = static_cast<Index>(row);
    for (std::int64_t edge = edges_.first[v]; edge < edges_.first[v + 1]; ++edge) {
      edge_blocks_[edge] = {matrix.find(v, edges_.ends[edge]), matrix.find(edges_.ends[edge], v)};
      for (const std::int64_t block : edge_blocks_[edge]) is_of_edge[block] = 1;
    }
  });
  other_blocks_.clear();
  for (std::size_t i = 0; i < is_of_edge.size(); ++i)
    if (is_of_edge[i] == 0) other_blocks_.push_back(static_cast<std::int64_t>(i));
  pattern_is_old_ = false;
}

/// Sets all blocks beside the diagonal to those of elements.
void IncrementalPotential::add_elements(BlockMatrix& matrix) const {
  parallel_for(std::ssize(other_blocks_), kPlaceGrain,
               [&](std::int64_t i) { matrix.blocks[other_blocks_[i]].setZero(); });
  parallel_for(vertex_count(), kEdgeRowGrain, [&](std::int64_t v) {
    for (std::int64_t edge = edges_.first[v]; edge < edges_.first[v + 1]; ++edge) {
      const Eigen::Matrix3d block = edges_.sum(element_derivatives_, edge);
      matrix.blocks[edge_blocks_[edge][0]] = block;
      matrix.blocks[edge_blocks_[edge][1]] = block.transpose();
    }
  });
}

/// What elements and inertia have in the row of a free vertex; moving all vertices alike changes no element.
void IncrementalPotential::finish_row(Index v, BlockMatrix& matrix, Eigen::Matrix3d& diagonal) const {
  diagonal = masses_[v] * Eigen::Matrix3d::Identity();
  for (std::int64_t i = matrix.first[v]; i < matrix.first[v + 1]; ++i) {
    if (matrix.columns[i] == v) continue;
    diagonal -= matrix.blocks[i];
    if (!is_free(matrix.columns[i])) matrix.blocks[i].setZero();
  }
}

Eigen::Vector3d IncrementalPotential::element_pull(Index v) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Index e : model_.mesh.vertex_elements(v)) {
    const auto& element = model_.mesh.elements()[e];
    sum += gradient_of(element_derivatives_[e].gradient,
                       static_cast<int>(std::find(element.begin(), element.end(), v) - element.begin()));
  }
  return sum;
}

bool IncrementalPotential::assemble(std::span<const Vec3> x, bool exact, Eigen::VectorXd& gradient,
                                    BlockMatrix& matrix) {
  const bool renews = pattern_is_old_ || matrix.first.empty();
  if (renews) renew_pattern(matrix);
  elements_.differentiate(x, exact, element_derivatives_);
  parallel_for(std::ssize(terms_), kPlaceGrain,
               [&](std::int64_t t) { term_derivatives_[t] = terms_[t].derivatives(terms_[t].offset(x)); });
  parallel_for(std::ssize(cloth_derivatives_), kEdgeRowGrain,
               [&](std::int64_t t) { cloth_derivatives_[t] = cloth_.derivatives(static_cast<Index>(t), x, exact); });
  add_elements(matrix);
  gradient.setZero(3 * Eigen::Index{vertex_count()});
  parallel_for(vertex_count(), kHessianRowGrain, [&](std::int64_t row) {
    const auto v = static_cast<Index>(row);
    Eigen::Matrix3d& diagonal = matrix.blocks[matrix.find(v, v)];
    if (!is_free(v)) {
      for (std::int64_t i = matrix.first[v]; i < matrix.first[v + 1]; ++i) matrix.blocks[i].setZero();
      diagonal.setIdentity();
      return;
    }
    finish_row(v, matrix, diagonal);
    Eigen::Vector3d sum = masses_[v] * (x[v] - targets_[v]) + element_pull(v);
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

}  // namespace selvage
