#include "contact/ways_out/straight_way.h"

#include "mesh/simplex_corners.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Sine of the angle to a face below which a straight way does not leave by it.
constexpr double kParallel = 1e-9;
/// Elements on a straight way, at most.
constexpr int kMaxElements = 1000;

}  // namespace

BoundaryPath<3> straight_way(const TetMesh& mesh, std::span<const Vec3> positions, const Vec3& point, Index element,
                             const Vec3& direction) {
  BoundaryPath<3> path;
  Index from = kNone;
  double way = 0;
  for (int visited = 0; visited < kMaxElements; ++visited) {
    int exit = -1;
    double nearest = HUGE_VAL;
    for (int face = 0; face < 4; ++face) {
      if (mesh.neighbours()[element][face].exists() && mesh.neighbours()[element][face].element() == from) continue;
      const auto corners = corners_of(TetMesh::face_of(mesh.elements()[element], face), positions);
      const Vec3 normal = area_normal(corners);
      const double speed = normal.dot(direction);
      if (!(speed > kParallel * normal.norm())) continue;
      const double at = normal.dot(corners[0] - point) / speed;
      if (at < nearest) nearest = at, exit = face;
    }
    if (exit < 0) return path;
    way = std::max(way, nearest);
    const HalfFace across = mesh.neighbours()[element][exit];
    if (across.exists()) {
      from = element;
      element = across.element();
      continue;
    }
    path.face = across.boundary_face();
    path.point = point + way * direction;
    path.distance = way;
    path.normal = direction;
    const auto corners = corners_of(mesh.boundary_faces()[path.face], positions);
    const Vec3 normal = area_normal(corners);
    for (int i = 0; i < 3; ++i) {
      const Vec3 &b = corners[(i + 1) % 3], &c = corners[(i + 2) % 3];
      path.barycentric[i] = std::clamp(normal.dot((c - b).cross(path.point - b)) / normal.squaredNorm(), 0.0, 1.0);
    }
    path.barycentric /= path.barycentric.sum();
    if (path.barycentric.allFinite() && path.point.allFinite()) path.status = PathStatus::kFound;
    return path;
  }
  return path;
}

std::vector<Vec3> directions_to_try(const Eigen::Matrix3d& spread) {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vec3(x, y, z).normalized());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) directions.push_back(sign * axes.eigenvectors().col(k));
  return directions;
}

}  // namespace selvage
