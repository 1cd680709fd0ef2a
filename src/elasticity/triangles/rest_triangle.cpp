#include "elasticity/triangles/rest_triangle.h"

#include <Eigen/Geometry>

namespace selvage {

namespace {

/// Part of a direction in a triangle's plane below which it counts as across it.
constexpr double kAcross = 1e-6;

}  // namespace

RestSimplex<2> rest_triangle(const StencilPositions<3>& corners, const Eigen::Vector3d& along) {
  const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
  const Eigen::Vector3d normal = a.cross(b).normalized(), direction = along.normalized();
  Eigen::Vector3d first = direction - normal.dot(direction) * normal;
  first = first.norm() > kAcross ? first.normalized() : a.normalized();
  const Eigen::Vector3d second = normal.cross(first);
  Eigen::Matrix2d edges;
  edges << first.dot(a), first.dot(b), second.dot(a), second.dot(b);
  return RestSimplex<2>::of(edges);
}

}  // namespace selvage
