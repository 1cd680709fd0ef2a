#pragma once

#include "selvage/contact/contact_finder.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/step.h"
#include "simulation/time_step/pieces.h"

#include <functional>

namespace selvage {

/// How a piece gets out of the solid colliders that it is across.
struct WayOutOfSolids {
  PieceWayOff off;            ///< its way is the longest of a vertex of the piece out of, or past, these solids
  std::vector<Index> solids;  ///< ascending numbers of colliders
};

/// Ways of connected pieces of elements that start a step across solids. Each vertex by itself would come out to its
/// own side: that hooks a piece around a solid, or tears it, or presses it flat. All of it has to go one way, through
/// the solid. The way is the shortest of some that is not blocked; a piece of which all are blocked, or of which the
/// way is so short that contacts do, is left out.
///
/// A piece is across a solid if an edge of an element is: between two sides of its middle, or all through it where it
/// is wide, or where its ends would come out half as far again from one another as at rest. And where the piece is deep
/// in one side of the solid, so that edges would be pressed to half of their lengths. So a ring that is pressed onto a
/// pole is not. O((n + edges + directions) solids), the most for meshes: log(triangles) times as much.
/// @param max_corrections  (n_vertices) [m] what is deeper is deep
/// @param is_blocked       of a piece, a way, and the solids that the way leads through
std::vector<WayOutOfSolids> ways_out_of_solids(
    const Model& model, const Pieces& pieces, std::span<const PreparedCollider> colliders, const Step& step,
    std::span<const double> max_corrections,
    const std::function<bool(Index, const Vec3&, std::span<const Index>)>& is_blocked);

}  // namespace selvage
