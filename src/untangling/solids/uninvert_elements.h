#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Where vertices may go.
struct Freedom {
  std::span<const std::uint8_t> is_free;  ///< (n_vertices)
  std::span<const Vec3> origin;           ///< (n_vertices) [m]
  double max_displacement;                ///< from there [m]

  bool allows(Index vertex, const Vec3& to) const {
    return is_free[vertex] != 0 && !((to - origin[vertex]).norm() > max_displacement);
  }
};

/// Makes inverted and flat elements positive by moving their vertices and those one ring around.
///
/// One vertex after the other descends the foldover energy (FoldoverEnergy): nearly infinite for a positive element
/// that becomes flat, finite but large and steep for an inverted one. So positive elements stay positive, and inverted
/// ones become so. The target of an element is its rest shape; where that is nearly flat, a thicker one.
///
/// @param rest       (n_vertices) [m]
/// @param inverted   elements to restore, ascending
/// @param freedom    of its vertices
/// @param positions  (n_vertices x 3) moved [m]
/// @return elements that are still inverted, of the whole mesh; ascending
///
/// Source: Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, Foldover-free maps in 50 lines of code.
std::vector<Index> uninvert_elements(const TetMesh& mesh, std::span<const Vec3> rest, std::span<const Index> inverted,
                                     const Freedom& freedom, std::span<Vec3> positions);

}  // namespace selvage
