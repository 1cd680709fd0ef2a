#pragma once

#include "selvage/simulation/model.h"
#include "simulation/implicit/incremental_potential.h"
#include "simulation/vbd/cloth_stars.h"
#include "simulation/vbd/star_kernel.h"
#include "simulation/vbd/vertex_colours.h"
#include "simulation/vbd/vertex_contacts.h"

namespace selvage {

/// The elements around each of some vertices, side by side: what IncrementalPotential::by_vertex() adds up, several
/// elements at a time. Undamped Neo-Hookean elements are batched; the others are left to the potential, one by one.
/// The same bits for every instruction set.
class VertexStars {
 public:
  /// @param colours  whose vertices' stars, in that order; must outlive this
  /// @param cloth    must outlive this, too
  VertexStars(const Model& model, const VertexColours& colours, const ClothTerms& cloth);

  /// Begins a step, after the potential.
  void begin() { cloth_.begin(); }

  /// Takes new positions of all vertices.
  void place(std::span<const Vec3> x);
  /// Takes one.
  void place(Index vertex, const Vec3& x);

  /// Sums over the batched elements of vertices[first] to before vertices[last], at the positions taken.
  void sum(Index first, Index last, StarSums* sums) const { sum_best(task(), first, last, sums); }

  /// Takes over the potential's contacts, before derivatives() and whenever they are new.
  void renew_contacts(const IncrementalPotential& potential) { contacts_.renew(potential); }

  /// Of one vertex.
  struct Derivatives {
    VertexDerivatives all;
    /// Of inertia, elements and flat hinges: of those that are not damped all that there is, as they are quadratic in
    /// one vertex.
    VertexDerivatives quadratic;
    double cloth_energy = 0;                         ///< of the cloth that is not [J]
    std::vector<VertexContacts::Placed> contacts{};  ///< where they are

    /// Of all that is not quadratic, where the vertex is [J].
    double energy() const { return cloth_energy + VertexContacts::energy(contacts, Vec3::Zero()); }
  };
  /// As IncrementalPotential::by_vertex() of vertices[i], for a step in which all of its colour move: where contacts
  /// join vertices of one colour, the Hessian is larger, so that they do not run past one another.
  void differentiate(const IncrementalPotential& potential, std::span<const Vec3> x, Index i, const StarSums& sums,
                     Derivatives& derivatives) const;

  /// Energy of all that is not quadratic, with the vertex moved on [J].
  double energy(std::span<const Vec3> x, Index i, const Vec3& move, const Derivatives& derivatives) const;

  const ClothStars& cloth() const { return cloth_; }

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
  ClothStars cloth_;
  VertexContacts contacts_;
};

}  // namespace selvage
