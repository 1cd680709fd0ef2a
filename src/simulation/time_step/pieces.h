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
  /// @param model  must outlive this
  explicit Pieces(const Model& model);

  Index count() const { return count_; }
  /// kNone: of no element or triangle of the model.
  Index of_vertex(Index v) const { return v >= 0 && v < std::ssize(of_vertex_) ? of_vertex_[v] : kNone; }

  /// visit(piece, v) of vertices that are not pinned. Parallel, O(n).
  template <typename Visit>
  void visit_vertices(Visit&& visit) const {
    parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
      for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i) visit(slices_[s].piece, vertices_[i]);
    });
  }

  /// (n_pieces) 1: one of its vertices that are not pinned is such a one. Parallel, O(n).
  template <typename Predicate>
  std::vector<std::uint8_t> pieces_with(Predicate&& is_such) const {
    std::vector<std::uint8_t> found(slices_.size(), 0), with(count_, 0);
    parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
      found[s] = std::any_of(vertices_.begin() + slices_[s].first, vertices_.begin() + slices_[s].last, is_such);
    });
    for (std::size_t s = 0; s < slices_.size(); ++s) with[slices_[s].piece] |= found[s];
    return with;
  }

  /// (n_pieces) of vertices that are not pinned, of the pieces that are asked for. Parallel, O(n).
  /// @param is_asked     by the number of a piece
  /// @param velocity_of  by the number of a vertex [m/s]
  template <typename IsAsked, typename VelocityOf>
  std::vector<MomentumSums> momentum(std::span<const Vec3> positions, IsAsked&& is_asked,
                                     VelocityOf&& velocity_of) const {
    std::vector<MomentumSums> of_pieces(count_);
    for (const Slice& slice : slices_)
      of_pieces[slice.piece] = MomentumSums(positions[vertices_[slice.first]], velocity_of(vertices_[slice.first]));
    std::vector<MomentumSums> sums(slices_.size());
    parallel_for(std::ssize(slices_), 1, [&](std::int64_t s) {
      sums[s] = of_pieces[slices_[s].piece];
      if (!is_asked(slices_[s].piece)) return;
      for (std::size_t i = slices_[s].first; i < slices_[s].last; ++i) {
        const Index v = vertices_[i];
        sums[s].add(1 / inverse_masses_[v], positions[v], velocity_of(v));
      }
    });
    for (std::size_t s = 0; s < slices_.size(); ++s) of_pieces[slices_[s].piece].add(sums[s]);
    return of_pieces;
  }

 private:
  /// Vertices of one piece that are summed together.
  struct Slice {
    Index piece;
    std::size_t first, last;
  };

  std::span<const double> inverse_masses_;
  Index count_ = 0;
  std::vector<Index> of_vertex_;
  std::vector<Index> vertices_;  ///< those that are not pinned, by pieces
  std::vector<Slice> slices_;    ///< by pieces
};

}  // namespace selvage
