#pragma once

#include "bvh/box.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Visits the boundary faces around a vertex that follow each other across ridges, starting with `face`: one corner of
/// the material. On a manifold boundary these are all faces of the vertex.
template <typename Visit>
SELVAGE_INLINE void visit_corner(const VertexTuple<3>* faces, const std::array<Index, 3>* neighbours, Index face,
                                 Index vertex, Visit&& visit) {
  Index current = face;
  Index behind = faces[face][0] != vertex ? faces[face][0] : faces[face][1];
  do {
    visit(current);
    const VertexTuple<3>& ids = faces[current];
    const int k = ids[0] == behind ? 0 : ids[1] == behind ? 1 : 2;
    Index ahead = ids[0];
    if (ahead == vertex || ahead == behind) ahead = ids[1];
    if (ahead == vertex || ahead == behind) ahead = ids[2];
    // Across the ridge (vertex, ahead) lies a face whose third vertex is the next one; it is left across that vertex.
    current = neighbours[current][k];
    behind = ahead;
  } while (current != face);
}

template <typename Visit>
SELVAGE_INLINE void visit_corner(const VertexTuple<2>* faces, const std::array<Index, 2>* neighbours, Index face,
                                 Index vertex, Visit&& visit) {
  visit(face);
  visit(neighbours[face][faces[face][0] == vertex ? 1 : 0]);
}

/// The same around the feature of a face that some of its vertices span: the face itself, the two faces of an edge, or
/// those around a vertex.
template <int D, typename Visit>
SELVAGE_INLINE void visit_feature(const VertexTuple<D>* faces, const std::array<Index, D>* neighbours, Index face,
                                  const VertexTuple<D>& feature, int count, Visit&& visit) {
  if (count == 1) return visit_corner(faces, neighbours, face, feature[0], visit);
  visit(face);
  if (count == D) return;
  for (int k = 0; k < D; ++k)
    if (faces[face][k] != feature[0] && faces[face][k] != feature[1]) visit(neighbours[face][k]);
}

}  // namespace selvage
