#pragma once

#include "boundary_path/input/rims.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Element as a tetrahedral traversal reads it: in one line of the cache.
template <int D>
struct alignas(32) PathElement {
  VertexTuple<D + 1> vertices;
  std::array<Index, D + 1> neighbours;  ///< codes of SimplexMesh::neighbours(), bare for the kernels
};

/// Boundary face as a search reads it: in one line of the cache.
template <int D>
struct alignas(32) FaceStar {
  VertexTuple<D> vertices;
  VertexTuple<D> apexes;  ///< of the neighbour opposite to each vertex the one that is not the face's
  Index component;
};

/// Topology of a mesh as searches read it, computed once.
template <int D>
struct PathTopology {
  explicit PathTopology(const SimplexMesh<D>& mesh);

  std::vector<Index> component_of;  ///< per element
  Index component_count = 0;

  /// Per element a boundary face that is as few elements away as any; kNone in a component without boundary.
  std::vector<Index> hints;

  std::vector<PathElement<D>> elements;

  std::vector<FaceStar<D>> face_stars;  ///< per boundary face

  /// Per vertex: 1 when its elements, or those of a boundary ridge at it, do not all hang together across faces, so
  /// that several corners of the material meet there.
  std::vector<std::uint8_t> is_split;

  std::vector<std::uint8_t> is_on_boundary;  ///< per vertex
  Index inner_vertex_count = 0;              ///< vertices of elements that are not on the boundary

  /// Faces that two neighbours do not list in opposite senses, so that positive ones would lie on one side of it: each
  /// as that of its first element, ascending. None where the mesh has one orientation.
  std::vector<HalfFace> disagreeing;

  /// Ridges (edges in 3D, vertices in 2D), each with the link of vertices around it.
  struct Fans {
    struct Fan {
      VertexTuple<D - 1> ridge;  ///< in 3D the link turns counter-clockwise about ridge[1] - ridge[0]
      Index element;             ///< one of its elements
      std::int64_t first_link;   ///< its share of `links` ends where the next one's begins
    };
    std::vector<Fan> fans;  ///< with a sentinel at the end
    std::vector<Index> links;

    std::int64_t count() const { return std::ssize(fans) - 1; }
    std::span<const Index> link(std::int64_t k) const {
      return {links.data() + fans[k].first_link, static_cast<std::size_t>(fans[k + 1].first_link - fans[k].first_link)};
    }
  };
  /// Interior ridges around which positive elements may turn twice: with fewer than five elements, each less than half
  /// a turn, they cannot. The link is closed. First come those, `spanning_count` of them, that have all their vertices
  /// on the boundary.
  Fans interior_fans;
  std::int64_t spanning_count = 0;
  /// Boundary ridges around which positive elements may turn by more than 2 pi: three at least. The link goes from one
  /// boundary face to the other.
  Fans boundary_fans;

  Rims rims;
};

extern template struct PathTopology<2>;
extern template struct PathTopology<3>;

}  // namespace selvage
