#pragma once

#include "boundary_path/normal_cones.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Outward normal of a boundary face, as long as the face (in the plane) or as twice its area.
Vec2 face_normal(std::span<const Vec2> positions, const VertexTuple<2>& face);
Vec3 face_normal(std::span<const Vec3> positions, const VertexTuple<3>& face);

/// Whether the boundary faces around a vertex are proven to be locally injective; if so, sets the box of their unit
/// normals. Sufficient, not necessary.
///
/// Source: docs/boundary_path.md. The slow twin of the kernel prove_rims(), for what single precision leaves open.
bool is_proven_injective(const SimplexMesh<2>& mesh, std::span<const Vec2> positions, Index vertex, NormalBox& normals);
bool is_proven_injective(const SimplexMesh<3>& mesh, std::span<const Vec3> positions, Index vertex, NormalBox& normals);

}  // namespace selvage
