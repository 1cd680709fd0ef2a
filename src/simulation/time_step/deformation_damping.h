#pragma once

#include "selvage/simulation/model.h"

namespace selvage {

/// Damping of all but the rigid motion of each connected piece of a model. A piece keeps its momentum and its angular
/// momentum, and falls and turns as without.
class DeformationDamping {
 public:
  /// @param model  must outlive this
  explicit DeformationDamping(const Model& model);

  /// Keeps a part of the velocities relative to the rigid motion. Pinned vertices do not count. The same bits for any
  /// number of threads. O(n).
  /// @param kept        of the relative velocities, 0 to 1
  /// @param positions   (n_vertices) [m]
  /// @param velocities  (n_vertices) [m/s]; updated
  void apply(double kept, std::span<const Vec3> positions, std::span<Vec3> velocities) const;

 private:
  /// Vertices of one piece that are summed together.
  struct Slice {
    Index piece;
    std::size_t first, last;
  };

  const Model& model_;
  Index piece_count_ = 0;
  std::vector<Index> vertices_;  ///< those that are not pinned, by pieces
  std::vector<Slice> slices_;    ///< by pieces
};

}  // namespace selvage
