#pragma once

#include "simulation/implicit/cloth_terms.h"
#include "simulation/vbd/cloth_star_kernel.h"
#include "simulation/vbd/vertex_colours.h"

#include <map>

namespace selvage {

/// The cloth around each of some vertices, side by side: what ClothTerms::add_by_vertex() and energy_by_vertex() add
/// up, several terms at a time. Isotropic triangles, flat hinges and damping of hinges are batched; woven triangles and
/// hinges that are bent at rest are left to ClothTerms, one by one. The same bits for every instruction set.
class ClothStars {
 public:
  /// @param rows      see StarTask; must outlive this, as must the others
  /// @param own_rows  likewise
  ClothStars(const ClothTerms& terms, const VertexColours& colours, const double* rows, const Index* own_rows);

  bool is_empty(Index i) const { return terms_.terms_of(colours_.vertices[i]).empty(); }

  /// Takes over what ClothTerms::begin() has found.
  void begin();

  /// Adds the derivatives at the positions taken.
  /// @param i         place of the vertex in the order of colours
  /// @param all       of all terms
  /// @param quadratic of those that are quadratic in the vertex
  /// @return the energy of the others [J]
  double add(std::span<const Vec3> x, Index i, VertexDerivatives& all, VertexDerivatives& quadratic) const;

  /// That energy with the vertex elsewhere.
  double energy(std::span<const Vec3> x, Index i, const Vec3& at) const;

  ClothStarTask task() const;

 private:
  /// A triangle's or a hinge's place in the batches of one of its vertices.
  struct Place {
    Index of;
    std::int64_t batch;
    int lane;
  };
  /// One that is made.
  struct Star {
    Index vertex;
    int triangles = 0, hinges = 0;       ///< batched so far
    std::map<Index, double> bendings{};  ///< weight by vertex
    double bending_stiffness = 0;
  };

  void add_triangle(Index term, Star& star);
  void add_hinge(Index term, Star& star);
  void add_bendings(Star& star);

  const ClothTerms& terms_;
  const VertexColours& colours_;
  const double* rows_;
  const Index* own_rows_;
  std::vector<TriangleStarBatch> triangles_;
  std::vector<BendingStarBatch> bendings_;
  std::vector<HingeStarBatch> hinges_;
  std::vector<std::int64_t> first_triangles_, first_bendings_, first_hinges_, first_others_;
  std::vector<Index> others_;  ///< terms that are not batched, star by star
  std::vector<Place> triangle_places_, hinge_places_;
  std::vector<double> bending_stiffness_;  ///< of each star: the Hessian of its flat hinges [N/m]
  bool is_damped_ = false;
};

}  // namespace selvage
