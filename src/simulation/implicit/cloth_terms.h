#pragma once

#include "elasticity/strain_damping.h"
#include "elasticity/triangles/membrane_neo_hookean.h"
#include "elasticity/triangles/membrane_weave.h"
#include "simulation/cloth_pieces.h"

#include <variant>

namespace selvage {

/// Energies of a model's cloth: of its triangles, and of its hinges, each with damping over a step.
class ClothTerms {
 public:
  ClothTerms(const Model& model, double time_step);

  Index count() const { return static_cast<Index>(triangles_.size() + hinges_.size()); }
  /// Three of a triangle, four of a hinge.
  std::span<const Index> vertices_of(Index term) const;
  /// Ascending.
  std::span<const Index> terms_of(Index vertex) const {
    return std::span(term_of_vertex_).subspan(term_first_[vertex], term_first_[vertex + 1] - term_first_[vertex]);
  }

  /// Begins a step.
  void begin(std::span<const Vec3> positions);

  double energy(Index term, std::span<const Vec3> x) const;

  /// By up to four vertices; what is of no vertex is 0.
  struct Derivatives {
    StencilGradient<4> gradient = StencilGradient<4>::Zero();
    StencilHessian<4> hessian = StencilHessian<4>::Zero();
  };
  StencilGradient<4> gradient(Index term, std::span<const Vec3> x) const;
  Derivatives derivatives(Index term, std::span<const Vec3> x, bool exact) const;

  /// Adds the derivatives of one of a vertex's terms by its position.
  void add_by_vertex(std::span<const Vec3> x, Index term, Index v, VertexDerivatives& sum) const;
  /// Energy of one of a vertex's terms, with the vertex where it is put and all others at x.
  double energy_by_vertex(std::span<const Vec3> x, Index term, Index v, const Vec3& at) const;

  struct Triangle {
    ClothTriangle piece;
    std::variant<MembraneNeoHookean, MembraneWeave> material;
    StrainDamping<2> damping;
  };
  struct Hinge {
    ClothHinge piece;
    HingeDamping damping;
  };
  /// Terms are these, then those.
  std::span<const Triangle> triangles() const { return triangles_; }
  std::span<const Hinge> hinges() const { return hinges_; }

 private:
  int place_of(Index term, Index vertex) const;
  template <typename Visit>
  void visit(Index term, std::span<const Vec3> x, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  std::vector<Hinge> hinges_;
  std::vector<Index> term_first_, term_of_vertex_;
};

}  // namespace selvage
