#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// An interior point whose shortest path to the boundary is asked for.
template <int D>
struct PathQuery {
  Vec<D> point;   ///< [m]
  Index element;  ///< the element that the point is taken to be in: one place may hold several material points
  /// Vertices that span the boundary simplex on which the point lies, when it is a boundary point that has penetrated:
  /// a vertex (v, kNone) or an edge (a, b). The boundary faces that have all of them are no candidates.
  std::array<Index, 2> source{kNone, kNone};

  /// A point of an element.
  static PathQuery at(const Vec<D>& point, Index element) { return {point, element, {kNone, kNone}}; }
  /// A boundary vertex that has penetrated an element.
  /// @param position  of the vertex [m]
  static PathQuery of_vertex(Index vertex, const Vec<D>& position, Index element) {
    return {position, element, {vertex, kNone}};
  }
  /// A point of a boundary edge that has penetrated an element.
  /// @param edge   its two vertices, in any order
  /// @param point  on the edge [m]
  static PathQuery of_edge(const VertexTuple<2>& edge, const Vec<D>& point, Index element) {
    return {point, element, edge};
  }
};

}  // namespace selvage
