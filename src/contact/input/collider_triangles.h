#pragma once

#include "selvage/mesh/simplex_mesh.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// A mesh's boundary faces, in their order, then triangles of colliders: on vertices that follow those of the mesh.
/// @throws Error  when a collider has a vertex of the mesh, or one that has no position
TriangleMesh surface_with_colliders(const TetMesh& mesh, std::span<const VertexTuple<3>> colliders,
                                    std::size_t position_count);

/// Options of a search on such a surface: pairs of colliders are none.
SelfCollisionOptions options_with_colliders(const TetMesh& mesh, const TriangleMesh& surface);

}  // namespace selvage
