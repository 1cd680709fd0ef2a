#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// A surface as it is cut: where each vertex is in the material, and the triangles between them.
struct Material {
  std::vector<Vec3> places;  ///< two coordinates on a piece, and the number of the piece
  std::vector<VertexTuple<3>> triangles;
};

/// Adds the piece [0, 1] x [0, 1] of columns x rows cells; of a tube, u = 1 is u = 0.
void add_piece(Material& material, Index columns, Index rows, bool is_tube);

/// A shirt of two layers that are sewn together at the sides, under the arms and on the shoulders; open at neck, hem
/// and cuffs. In place of the number of the piece: 1 on the front, -1 on the back, 0 on the seams.
///
/// @param k  cells along the unit of the pattern: 14 wide and 17 high, sleeves 5 x 5, the neck 4 x 2
Material make_shirt(Index k);

/// The range of the coordinates of make_shirt(): from -12 to 12, sleeves included, and from 0 to 17.
inline constexpr double kShirtReach = 12, kShirtHeight = 17;

}  // namespace selvage
