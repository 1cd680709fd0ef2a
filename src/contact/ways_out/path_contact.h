#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/contact/contact.h"

namespace selvage {

/// A point inside an element, as a weighted sum of vertices, and the query for its way out.
struct PenetratingPoint {
  ContactKind kind = ContactKind::kVertexPath;
  Index feature = kNone;  ///< vertex, boundary edge or element
  int count = 0;          ///< vertices
  std::array<Index, 4> vertices{};
  std::array<double, 4> weights{};
  PathQuery<3> query;
  Index tangle = 0;  ///< see number_tangles()
};

PenetratingPoint penetrating_vertex(Index vertex, Index element, std::span<const Vec3> positions);
/// @param middle  of the part inside: 0 at the edge's first vertex, 1 at its second
PenetratingPoint penetrating_edge(Index edge, const VertexTuple<2>& vertices, double middle, Index element,
                                  std::span<const Vec3> positions);
PenetratingPoint penetrating_centroid(Index of_element, const VertexTuple<4>& vertices, Index element,
                                      std::span<const Vec3> positions);

/// The contact of a point and the closest boundary point that was found for it.
Contact path_contact(const TetMesh& mesh, const PenetratingPoint& point, const BoundaryPath<3>& path);

/// The contact of a point of a collider: not the face at the end of its way out is moved, but the element that it is
/// in, against that way. So a body moves off as a whole. Moved alone, the face would be pulled through what lies
/// between, as the collider cannot come to meet it. Without vertices where the element is flat, or the way has no
/// length.
/// @param positions  (n_vertices) [m]
Contact collider_path_contact(const TetMesh& mesh, std::span<const Vec3> positions, const PenetratingPoint& point,
                              const BoundaryPath<3>& path);

/// Outward unit normal of the boundary at a point of a face: area-weighted over all faces that have the vertices whose
/// barycentric coordinates there are not 0; where they cancel, the face's own. Zero where that is flat.
Vec3 outward_normal(const TetMesh& mesh, std::span<const Vec3> positions, Index face,
                    const std::array<double, 3>& barycentric);

}  // namespace selvage
