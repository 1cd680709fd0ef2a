#pragma once

#include "core/parallel.h"
#include "selvage/simulation/model.h"
#include "simulation/rigid_motion.h"

#include <algorithm>

namespace selvage {

/// The connected pieces of a model: of bodies of elements those connected across faces, of cloth across vertices.
/// Sums over a piece are the same bits for any number of threads.
class Pieces {
 public:
  explicit Pieces(const Model& model);

  Index count() const { return count_; }
  /// kNone: of no element or triangle of the model.
  Index of_vertex(Index v) const { return v >= 0 && v < std::ssize(of_vertex_) ? of_vertex_[v] : kNone; }

  /// Of those that are not pinned; kNone: all are.
  Index first_vertex(Index piece) const { return first_vertices_[piece]; }

  /// visit(piece, v) of vertices that are not pinned. Parallel, O(n).
  template <typename Visit>
  void visit_vertices(Visit&& visit) const {
    parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
      for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i) visit(slices_[s].piece, vertices_[i]);
    });
  }

  /// (n_pieces) of vertices that are not pinned. Parallel, O(n).
  /// @param velocity_of  by the number of a vertex [m/s]
  /// @param is_asked     by the number of a piece: the others stay without
  template <typename VelocityOf, typename IsAsked>
  std::vector<MomentumSums> momentum(std::span<const Vec3> positions, VelocityOf&& velocity_of,
                                     IsAsked&& is_asked) const {
    std::vector<MomentumSums> of_pieces(count_), sums(slices_.size());
    for (const Slice& slice : slices_)
      of_pieces[slice.piece] = MomentumSums(positions[vertices_[slice.first]], velocity_of(vertices_[slice.first]));
    parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
      MomentumSums sum = of_pieces[slices_[s].piece];
      if (is_asked(slices_[s].piece))
        for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i)
          sum.add(masses_[i], positions[vertices_[i]], velocity_of(vertices_[i]));
      sums[s] = sum;
    });
    for (std::size_t s = 0; s < slices_.size(); ++s) of_pieces[slices_[s].piece].add(sums[s]);
    return of_pieces;
  }
  template <typename VelocityOf>
  std::vector<MomentumSums> momentum(std::span<const Vec3> positions, VelocityOf&& velocity_of) const {
    return momentum(positions, velocity_of, [](Index) { return true; });
  }

 private:
  /// Vertices of one piece that are summed together.
  struct Slice {
    Index piece;
    std::size_t first, last;
  };

  Index count_ = 0;
  std::vector<Index> of_vertex_;
  std::vector<Index> vertices_;        ///< those that are not pinned, by pieces
  std::vector<double> masses_;         ///< of these [kg]
  std::vector<Slice> slices_;          ///< by pieces
  std::vector<Index> first_vertices_;  ///< (n_pieces)
};

}  // namespace selvage
