#pragma once

#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// What searches need to know of a mesh beside its topology, computed once.
template <int D>
struct PathTopology {
  explicit PathTopology(const SimplexMesh<D>& mesh);

  std::vector<Index> component_of;  ///< per element
  Index component_count = 0;

  /// Per element a boundary face that is as few elements away as any; kNone in a component without boundary.
  std::vector<Index> hints;

  /// An interior ridge (an edge in 3D, a vertex in 2D) around which positive elements may turn twice: with fewer than
  /// five elements, each less than half a turn, they cannot.
  struct Fan {
    VertexTuple<D - 1> ridge;  ///< in 3D the link turns counter-clockwise about ridge[1] - ridge[0]
    Index element;             ///< one of its elements
    std::int64_t first_link;   ///< its share of `links` ends where the next one's begins
  };
  std::vector<Fan> fans;  ///< with a sentinel at the end
  std::vector<Index> links;
};

extern template struct PathTopology<2>;
extern template struct PathTopology<3>;

/// The link vertices around the ridge opposite to vertex `corner` of a boundary face, from that vertex through the
/// elements to the boundary face on the other side of the ridge.
template <int D>
void collect_boundary_link(const SimplexMesh<D>& mesh, Index face, int corner, std::vector<Index>& link);

extern template void collect_boundary_link<2>(const SimplexMesh<2>&, Index, int, std::vector<Index>&);
extern template void collect_boundary_link<3>(const SimplexMesh<3>&, Index, int, std::vector<Index>&);

}  // namespace selvage
