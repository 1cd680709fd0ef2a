#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// One side of a face: the element it belongs to and the number of the vertex of that element opposite to it. In a
/// table of neighbours, what lies across a face: the side of the neighbour, or else the boundary.
///
/// Packed in one index, so that such a table is one index a face: 4 * element + face, or ~b at boundary face b.
struct HalfFace {
  Index code = kNone;

  static HalfFace of(Index element, int face) { return {4 * element + face}; }
  static HalfFace at_boundary(Index boundary_face) { return {~boundary_face}; }
  /// False on the boundary: then element() and face() have no meaning.
  bool exists() const { return code >= 0; }
  Index element() const { return code >> 2; }
  int face() const { return code & 3; }
  /// In a table of neighbours, where nothing lies across.
  Index boundary_face() const { return ~code; }
  friend bool operator==(HalfFace, HalfFace) = default;
};

/// Boundary of two neighbouring boundary faces: an edge in 3D, a vertex in the plane.
template <int D>
struct BoundaryRidge {
  VertexTuple<D - 1> vertices;  ///< ascending
  std::array<Index, 2> faces;   ///< the boundary faces on both sides, ascending
};

/// Topology of a mesh of D-simplices in D dimensions: triangles in the plane (D = 2), tetrahedra in space (D = 3).
///
/// Positions are not part of it: a simulator hands in new ones every step at no cost. Any number of components and
/// objects may share one mesh. Vertices that no element uses are allowed.
///
/// Conventions: face i of an element is opposite to its vertex i and listed so that its normal points outward when the
/// element is positive. Two elements are neighbours when they share a face; a face that belongs to one element only is
/// a boundary face. Two boundary faces are neighbours across a ridge when one reaches the other by turning around the
/// ridge from element to element, so that each boundary face has exactly one neighbour across each of its ridges, on
/// non-manifold ridges too.
///
/// Thread-safe: all members are const after construction.
template <int D>
class SimplexMesh {
 public:
  using Element = VertexTuple<D + 1>;
  using Face = VertexTuple<D>;

  SimplexMesh() = default;

  /// Builds the topology: O(n), parallel; about 60 bytes an element kept, at most 160 while building (D = 3).
  ///
  /// @param vertex_count  number of vertices; every index lies in [0, vertex_count)
  /// @param elements      vertices of each element
  /// @throws Error        when there is no element, an index is out of range, an element repeats a vertex, or more than
  ///                      two elements share a face; it names the element
  SimplexMesh(Index vertex_count, std::vector<Element> elements);

  /// Vertices without any element, as those of a model in which all is cloth. A PointLocator of it finds nothing.
  static SimplexMesh without_elements(Index vertex_count);

  Index vertex_count() const { return vertex_count_; }
  Index element_count() const { return static_cast<Index>(elements_.size()); }
  Index boundary_face_count() const { return static_cast<Index>(boundary_faces_.size()); }

  /// (n_elements) vertices of each element, as they were given.
  std::span<const Element> elements() const { return elements_; }

  /// (n_elements x D+1) what lies across each face: the neighbour's side of it, or the boundary.
  std::span<const std::array<HalfFace, D + 1>> neighbours() const { return neighbours_; }

  /// (n_boundary) vertices of each boundary face, outward; ordered by (owner element, face number).
  std::span<const Face> boundary_faces() const { return boundary_faces_; }

  /// (n_boundary) the element and face number that each boundary face belongs to.
  std::span<const HalfFace> boundary_owners() const { return boundary_owners_; }

  /// (n_boundary x D) boundary face across the ridge opposite to vertex i of each boundary face.
  std::span<const std::array<Index, D>> boundary_neighbours() const { return boundary_neighbours_; }

  /// Vertices that lie on a boundary face, ascending.
  std::span<const Index> boundary_vertices() const { return boundary_vertices_; }

  /// Elements that have vertex v, ascending.
  std::span<const Index> vertex_elements(Index v) const { return star(vertex_element_, vertex_element_first_, v); }

  /// Boundary faces that have vertex v, ascending.
  std::span<const Index> vertex_boundary_faces(Index v) const {
    return star(vertex_boundary_face_, vertex_boundary_face_first_, v);
  }

  /// Edges of all elements, each once: vertices ascending, edges in lexicographic order. O(n), parallel.
  std::vector<VertexTuple<2>> edges() const;

  /// All boundary ridges, each once per pair of faces that meet there, ascending by the smaller face. O(n_boundary).
  std::vector<BoundaryRidge<D>> boundary_ridges() const;

  /// Face `face` of an element, outward.
  static Face face_of(const Element& element, int face);

  /// Connected component (across faces) of each element, numbered from 0 in order of their first elements. O(n).
  std::vector<Index> element_components() const;

 private:
  static std::span<const Index> star(const std::vector<Index>& items, const std::vector<Index>& first, Index v) {
    return {items.data() + first[static_cast<std::size_t>(v)], items.data() + first[static_cast<std::size_t>(v) + 1]};
  }
  void build();
  void find_neighbours();
  void list_boundary();
  void link_boundary();

  Index vertex_count_ = 0;
  std::vector<Element> elements_;
  std::vector<std::array<HalfFace, D + 1>> neighbours_;
  std::vector<Face> boundary_faces_;
  std::vector<HalfFace> boundary_owners_;
  std::vector<std::array<Index, D>> boundary_neighbours_;
  std::vector<Index> boundary_vertices_;
  std::vector<Index> vertex_element_, vertex_element_first_;
  std::vector<Index> vertex_boundary_face_, vertex_boundary_face_first_;
};

using TetMesh = SimplexMesh<3>;
using PlanarMesh = SimplexMesh<2>;

template <>
inline VertexTuple<3> SimplexMesh<3>::face_of(const Element& e, int face) {
  switch (face) {
    case 0:
      return {e[1], e[2], e[3]};
    case 1:
      return {e[0], e[3], e[2]};
    case 2:
      return {e[0], e[1], e[3]};
    default:
      return {e[0], e[2], e[1]};
  }
}

template <>
inline VertexTuple<2> SimplexMesh<2>::face_of(const Element& e, int face) {
  switch (face) {
    case 0:
      return {e[1], e[2]};
    case 1:
      return {e[2], e[0]};
    default:
      return {e[0], e[1]};
  }
}

extern template class SimplexMesh<2>;
extern template class SimplexMesh<3>;

}  // namespace selvage
