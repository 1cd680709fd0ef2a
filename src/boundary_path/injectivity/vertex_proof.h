#pragma once

#include "boundary_path/input/normal_cones.h"
#include "selvage/mesh/simplex_mesh.h"

namespace selvage {

/// Outward normal of a boundary face, as long as the face (in the plane) or as twice its area.
inline Vec2 face_normal(std::span<const Vec2> positions, const VertexTuple<2>& face) {
  const Vec2 along = positions[face[1]] - positions[face[0]];
  return {along[1], -along[0]};
}
inline Vec3 face_normal(std::span<const Vec3> positions, const VertexTuple<3>& face) {
  const Vec3 &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
  const double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

/// Whether the boundary faces around a vertex are proven to be locally injective; if so, sets the box of their unit
/// normals. Sufficient, not necessary.
///
/// Source: docs/how_it_works/boundary_path.md. The slow twin of the kernel prove_rims(), for what single precision
/// leaves open.
bool is_proven_injective(const SimplexMesh<2>& mesh, std::span<const Vec2> positions, Index vertex, NormalBox& normals);
bool is_proven_injective(const SimplexMesh<3>& mesh, std::span<const Vec3> positions, Index vertex, NormalBox& normals);

}  // namespace selvage
