#pragma once

#include "elasticity/neo_hookean.h"
#include "elasticity/strain_damping.h"
#include "elasticity/volume_spring.h"
#include "selvage/simulation/model.h"
#include "simulation/elements/element_kernel.h"

#include <variant>

namespace selvage {

/// Energies of a model's elements, each with its damping over a step. Neo-Hookean elements are taken several at a time;
/// volumes of mass-spring bodies one by one. The same bits for every instruction set and any number of threads.
class ElementTerms {
 public:
  /// @param model  must outlive this; mass-spring bodies have compliances above 0
  ElementTerms(const Model& model, double time_step);

  Index count() const { return static_cast<Index>(elements_.size()); }
  /// Of elements, and behind them those of batches' empty places, which mean nothing.
  std::size_t record_count() const { return elements_.size() + spare_; }

  /// Begins a step.
  void begin(std::span<const Vec3> positions);

  /// Of all [J].
  double energy(std::span<const Vec3> x) const;
  /// @param gradients  of each; record_count() of them afterwards
  void find_gradients(std::span<const Vec3> x, std::vector<ElementGradient>& gradients) const;
  /// @param is_exact     as in IncrementalPotential::assemble()
  /// @param derivatives  of each; record_count() of them afterwards
  void differentiate(std::span<const Vec3> x, bool is_exact, std::vector<ElementDerivatives>& derivatives) const;

  /// Adds the derivatives of one of a vertex's elements by its position.
  void add_by_vertex(std::span<const Vec3> x, Index element, Index v, VertexDerivatives& sum) const;

  /// Stiffness of the material of an element at rest, by its k-th vertex: a third of the trace [N/m].
  double rest_stiffness(Index element, int k) const;

  ElementTask task(std::span<const double> rows) const { return {rows.data(), batches_.data(), is_damped()}; }
  std::span<const SolidBatch> batches() const { return batches_; }

 private:
  /// Energies of an element.
  struct Element {
    RestSimplex<3> rest;
    std::variant<NeoHookean, VolumeSpring> material;
  };

  void add_batches(const Body& body);
  bool is_damped() const { return !start_gradients_.empty(); }
  template <typename Visit>
  void visit_densities(Index e, const Visit& visit) const;
  Eigen::Matrix3d deformation(Index e, std::span<const Vec3> x) const {
    return elements_[e].rest.deformation(gather(model_.mesh.elements()[e], x));
  }
  ElementDerivatives derivatives_of_one(Index e, std::span<const Vec3> x, bool is_exact) const;

  const Model& model_;
  std::vector<Element> elements_;
  std::vector<double> damping_;  ///< (n_elements) Material::damping over the step
  /// (n_elements) at the start of the step; empty where no body is damped
  std::vector<Eigen::Matrix3d> start_gradients_;
  std::vector<SolidBatch> batches_;
  Index spare_ = 0;            ///< records behind the last, one a body
  std::vector<Index> others_;  ///< elements that are not batched
};

/// The block of an element's Hessian of its vertices k and l, which differ.
inline Eigen::Matrix3d block_of(const ElementDerivatives& derivatives, int k, int l) {
  constexpr int kPlace[4][4] = {{-1, 0, 1, 2}, {0, -1, 3, 4}, {1, 3, -1, 5}, {2, 4, 5, -1}};
  const Eigen::Map<const Eigen::Matrix3d> block(derivatives.blocks[kPlace[k][l]]);
  return k < l ? Eigen::Matrix3d(block) : Eigen::Matrix3d(block.transpose());
}

/// The gradient by vertex k, of gradients by vertices 1 to 3.
template <std::size_t N>
Eigen::Vector3d gradient_of(const double (&by_vertex)[3][N], int k) {
  const auto of = [&](int i) { return Eigen::Map<const Eigen::Vector3d>(by_vertex[i - 1]); };
  return k > 0 ? Eigen::Vector3d(of(k)) : Eigen::Vector3d(-(of(1) + of(2) + of(3)));
}

}  // namespace selvage
