#pragma once

#include "selvage/simulation/model.h"
#include "simulation/implicit/incremental_potential.h"
#include "simulation/vbd/star_kernel.h"
#include "simulation/vbd/vertex_colours.h"

namespace selvage {

/// The elements around each of some vertices, side by side: what IncrementalPotential::by_vertex() adds up, several
/// elements at a time. Undamped Neo-Hookean elements are batched; the others are left to the potential, one by one.
/// The same bits for every instruction set.
class VertexStars {
 public:
  /// @param colours  whose vertices' stars, in that order; must outlive this
  VertexStars(const Model& model, const VertexColours& colours);

  /// Takes new positions of all vertices.
  void place(std::span<const Vec3> x);
  /// Takes one.
  void place(Index vertex, const Vec3& x);

  /// Sums over the batched elements of vertices[first] to before vertices[last], at the positions taken.
  void sum(Index first, Index last, StarSums* sums) const { sum_best(task(), first, last, sums); }

  /// As IncrementalPotential::by_vertex() of vertices[i], for a step in which all of its colour move: where contacts
  /// join vertices of one colour, the Hessian is larger, so that they do not run past one another.
  /// @param quadratic  the part of inertia and elements: of those that are not damped all that there is, as they are
  ///                   quadratic in one vertex
  VertexDerivatives derivatives(const IncrementalPotential& potential, std::span<const Vec3> x, Index i,
                                const StarSums& sums, VertexDerivatives& quadratic) const;

  StarTask task() const { return {rows_.data(), own_rows_.data(), batches_.data(), first_batches_.data()}; }
  /// By the best kernel of this processor.
  static void sum_best(const StarTask& task, Index first, Index last, StarSums* sums);

 private:
  void add_batch(Index vertex);

  const VertexColours& colours_;
  std::vector<double> rows_;
  std::vector<Index> own_rows_;
  std::vector<StarBatch> batches_;
  std::vector<std::int64_t> first_batches_;
  std::vector<double> isotropic_;  ///< of each star: its Hessian's part that is the same in all poses [N/m]
  std::vector<Index> others_;      ///< elements that are not batched, star by star
  std::vector<std::int64_t> first_others_;
};

}  // namespace selvage
