#include "boundary_path/injectivity/vertex_proof.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

constexpr double kMargin = 1e-9;  ///< relative; far above rounding

/// Takes in a unit vector, rounded outward; the normal of a flat face, 0, may be any.
template <int D>
void add_normal(const Vec<D>& unit, NormalBox& box) {
  if (unit.isZero(0)) box = NormalBox::everything();
  constexpr float kRounding = 1e-6f;
  for (int i = 0; i < 3; ++i) {
    const float x = i < D ? static_cast<float>(unit[i]) : 0;
    box.lower[i] = std::min(box.lower[i], x - kRounding);
    box.negated_upper[i] = std::min(box.negated_upper[i], -x - kRounding);
  }
}

template <int D>
Vec<D> unit_normal(std::span<const Vec<D>> positions, const VertexTuple<D>& face) {
  const Vec<D> normal = face_normal(positions, face);
  const double length = normal.norm();
  return length > 0 ? Vec<D>(normal / length) : Vec<D>::Zero();
}

}  // namespace

/// In the plane the elements must also turn by less than 2 pi: that is tested with the boundary ridges.
bool is_proven_injective(const SimplexMesh<2>& mesh, std::span<const Vec2> positions, Index vertex,
                         NormalBox& normals) {
  const auto star = mesh.vertex_boundary_faces(vertex);
  if (star.size() != 2) return false;
  normals = NormalBox::nothing();
  for (Index face : star) add_normal<2>(unit_normal<2>(positions, mesh.boundary_faces()[face]), normals);
  return true;
}

/// Seen along the average normal, the boundary faces around the vertex all turn the same way and go around once.
bool is_proven_injective(const SimplexMesh<3>& mesh, std::span<const Vec3> positions, Index vertex,
                         NormalBox& normals) {
  const auto star = mesh.vertex_boundary_faces(vertex);
  Vec3 axis = Vec3::Zero();
  for (Index face : star) axis += face_normal(positions, mesh.boundary_faces()[face]);
  // A half plane that no edge is likely to lie in; an edge too close to it leaves the vertex unproven.
  const Vec3 across = axis.cross(Vec3(0.3571, 0.6139, 0.7041));
  const double axis_length = axis.norm(), across_length = across.norm();
  normals = NormalBox::nothing();
  int turns = 0;
  for (Index face : star) {
    const auto& f = mesh.boundary_faces()[face];
    const Vec3 normal = unit_normal<3>(positions, f);
    if (!(normal.dot(axis) > kMargin * axis_length)) return false;
    add_normal<3>(normal, normals);
    const int i = f[0] == vertex ? 0 : f[1] == vertex ? 1 : 2;
    const Vec3 from = positions[f[(i + 1) % 3]] - positions[vertex], to = positions[f[(i + 2) % 3]] - positions[vertex];
    const double a = across.dot(from), b = across.dot(to);
    if (!(std::abs(a) > kMargin * from.norm() * across_length)) return false;
    turns += a < 0 && b > 0;
  }
  return turns == 1;
}

}  // namespace selvage
