#pragma once

#include "simulation/elements/element_edges.h"
#include "simulation/elements/element_terms.h"
#include "simulation/implicit/block_matrix.h"
#include "simulation/implicit/cloth_terms.h"
#include "simulation/implicit/offset_term.h"
#include "simulation/step.h"
#include "simulation/step_vertex.h"

namespace selvage {

/// What a step of backward Euler minimises over the positions x of the vertices:
///
///     sum of m/(2 h^2) |x - y|^2 + elastic energy + damping + contacts,
///
/// with y where inertia and external forces alone take the vertices. Vertices that are held do not move and count for
/// nothing. All sums have a fixed order: the same bits for any number of threads.
/// Sources: Martin, Thomaszewski, Grinspun, Gross 2011 (the potential); Chen, Diaz, Yuksel 2023, equation 7 (contacts).
class IncrementalPotential {
 public:
  /// @param model  must outlive this
  /// @throws Error  when a mass-spring body is rigid (a compliance is 0)
  IncrementalPotential(const Model& model, double time_step);

  /// Begins a step without contacts.
  /// @param vertices  where inertia and external forces take them, and those that are held without inverse mass
  void begin(const Step& step, std::span<const StepVertex> vertices);

  /// Takes contacts and collider contacts, replacing those of before. Each acts from its target on: see
  /// contact_terms.h.
  void set_contacts(std::vector<OffsetTerm> contacts);

  /// Lets friction follow from the normal forces at x.
  /// @param first  whether contacts are new: normal forces are then at most what stops the vertices, however deep x is
  void renew_friction(std::span<const Vec3> x, bool first);

  double energy(std::span<const Vec3> x) const;

  /// @param gradient  (3 n_vertices); 0 for vertices that are held
  void find_gradient(std::span<const Vec3> x, Eigen::VectorXd& gradient) const;

  /// Gradient and Hessian; rows and columns of held vertices are those of the identity.
  /// @param exact   the exact Hessian of the elements, which may be indefinite; else a positive semi-definite one
  /// @param matrix  its blocks are filled; its pattern is renewed where contacts have changed
  /// @return whether the pattern has changed
  bool assemble(std::span<const Vec3> x, bool exact, Eigen::VectorXd& gradient, BlockMatrix& matrix);

  /// Gradient and Hessian by one vertex that is free.
  VertexDerivatives by_vertex(std::span<const Vec3> x, Index v) const;
  /// Its parts, in their order: inertia, elements(), cloth(), and springs, damping of springs and
  /// contacts.
  VertexDerivatives inertia_by_vertex(std::span<const Vec3> x, Index v) const;
  void add_terms_by_vertex(std::span<const Vec3> x, Index v, VertexDerivatives& sum) const;

  const ElementTerms& elements() const { return elements_; }
  const ClothTerms& cloth() const { return cloth_; }
  bool is_free(Index v) const { return masses_[v] > 0; }
  /// Mass over the squared step, 0 for held vertices [N/m].
  double inertia(Index v) const { return masses_[v]; }
  /// How stiffly a vertex resists at rest: inertia and elements [N/m]; infinite where it is held.
  double stiffness(Index v) const;
  Index vertex_count() const { return model_.mesh.vertex_count(); }
  std::span<const OffsetTerm> terms() const { return terms_; }
  std::size_t contact_count() const { return terms_.size() - fixed_terms_; }
  std::span<const Index> terms_of(Index v) const {
    return std::span(term_of_vertex_).subspan(term_first_[v], term_first_[v + 1] - term_first_[v]);
  }

 private:
  void add_springs(const Body& body);
  void join_terms();
  void find_fixed_pattern();
  void renew_pattern(BlockMatrix& matrix);
  void add_elements(BlockMatrix& matrix) const;
  void finish_row(Index v, BlockMatrix& matrix, Eigen::Matrix3d& diagonal) const;
  Eigen::Vector3d element_pull(Index v) const;
  void add_cloth_row(Index v, BlockMatrix& matrix, Eigen::Vector3d& sum) const;

  const Model& model_;
  double time_step_;
  ElementTerms elements_;
  std::vector<double> rest_stiffness_;  ///< (n_vertices) of elements and springs [N/m]
  ClothTerms cloth_;
  std::vector<OffsetTerm> springs_;
  std::vector<double> spring_damping_;  ///< of each

  std::vector<double> masses_;     ///< (n_vertices) over the squared step; 0: held
  std::vector<Vec3> targets_;      ///< (n_vertices) y
  std::vector<OffsetTerm> terms_;  ///< springs, their damping, contacts
  std::size_t fixed_terms_ = 0;    ///< those before contacts
  std::vector<std::size_t> term_first_;
  std::vector<Index> term_of_vertex_;
  bool pattern_is_old_ = true, pattern_has_pairs_ = false;

  // Of the matrix; empty before the first.
  BlockMatrix fixed_pattern_;  ///< without contacts, without blocks
  ElementEdges edges_;
  std::vector<std::array<std::int64_t, 2>> edge_blocks_;  ///< (n_edges) above the diagonal, and below
  std::vector<std::int64_t> other_blocks_;                ///< those of no edge

  std::vector<ElementDerivatives> element_derivatives_;
  std::vector<OffsetTerm::Derivatives> term_derivatives_;
  std::vector<ClothTerms::Derivatives> cloth_derivatives_;
};

/// See StepStatistics::residual. [m]
double residual_of(const IncrementalPotential& potential, std::span<const Vec3> x);

}  // namespace selvage
