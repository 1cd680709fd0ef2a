#pragma once

#include "self_collision/surface/discrete_input.h"
#include "self_collision/surface/neighbour_pair.h"

namespace selvage {

/// Vertices of the triangles in the leaves, per node.
///
/// @param triangle_of  per primitive its triangle; empty: the same
std::vector<LeafVertices> list_leaf_vertices(const Bvh& bvh, std::span<const VertexTuple<3>> triangles,
                                             std::span<const Index> triangle_of = {});

/// All neighbours of a hierarchy over a surface. Their boxes meet in every pose, so that they need not be searched for:
/// the list holds as long as the hierarchy is refitted, and triangles outside it share no vertex. O(n) for
/// surfaces without vertices of very many triangles, below which pairs are left unlisted.
///
/// @param leaves  of the same hierarchy, see list_leaf_vertices()
std::vector<NeighbourPair> list_neighbours(const Bvh& bvh, std::span<const LeafVertices> leaves);

/// How many pieces to cut a search of a hierarchy into: enough that threads stay busy where pieces differ in size, and
/// not so many that they are hardly begun, for one thread cuts while the others wait.
std::size_t piece_count(const Bvh& bvh);

/// A search of a surface against itself, cut into independent pieces.
struct SelfWork {
  std::vector<SelfPiece> pieces;
  std::vector<IndexPair> found;  ///< pairs of triangles met while cutting; in no piece
  SelfCollisionCounters counters;
};

/// Cuts the search into at least `wanted` pieces, where there are as many. The same pieces in the same order, whatever
/// the number of threads.
SelfWork split_self_work(const Bvh& bvh, std::span<const NeighbourPair> neighbours, const CulledNodes& culled,
                         std::size_t wanted);

}  // namespace selvage
