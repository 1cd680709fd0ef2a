#pragma once

#include "selvage/mesh/simplex_mesh.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// A mesh's boundary faces, in their order, then cloth, then triangles of colliders: on vertices that follow those of
/// the mesh.
/// @throws Error  when a collider has a vertex of the mesh, or one that has no position; when cloth has a vertex that
///                the mesh has not, or one of an element
TriangleMesh surface_with_colliders(const TetMesh& mesh, std::span<const VertexTuple<3>> colliders,
                                    std::size_t position_count, std::span<const VertexTuple<3>> cloth = {});

/// Options of a search on such a surface: pairs of colliders are none.
/// @param body_faces  triangles of bodies: boundary faces and cloth
SelfCollisionOptions options_with_colliders(Index body_faces, const TriangleMesh& surface);

}  // namespace selvage
