#include "selvage/bvh/traverse.h"
#include "selvage/core/error.h"
#include "selvage/geometry/closest_point.h"
#include "simulation/obstacle.h"

#include <fmt/format.h>

#include <bit>

namespace selvage {

namespace {

TriangleMesh surface_of(const std::string& where, const MeshShape& shape) {
  try {
    return {static_cast<Index>(shape.positions.size()), shape.triangles};
  } catch (const Error& error) {
    throw Error(where, error.what());
  }
}

}  // namespace

MeshSolid::MeshSolid(const std::string& where, const MeshShape& shape)
    : positions_(shape.positions), mesh_(surface_of(where, shape)) {
  for (const Vec3& p : positions_) {
    if (!p.allFinite()) throw Error(where, "a position of its mesh is not finite");
    bounds_.extend(p);
  }
  for (Index e = 0; e < mesh_.edge_count(); ++e)
    if (mesh_.edge_triangles(e).size() != 2)
      throw Error(where,
                  fmt::format("the edge of its vertices {} and {} has {} triangles", mesh_.edges()[e][0],
                              mesh_.edges()[e][1], mesh_.edge_triangles(e).size()),
                  "give a closed surface, on which each has two");
  std::vector<Box> boxes;
  edge_normals_.assign(mesh_.edge_count(), Vec3::Zero());
  vertex_normals_.assign(positions_.size(), Vec3::Zero());
  for (Index t = 0; t < mesh_.triangle_count(); ++t) {
    const auto& triangle = mesh_.triangles()[t];
    const std::array<Vec3, 3> corners{positions_[triangle[0]], positions_[triangle[1]], positions_[triangle[2]]};
    boxes.push_back(bounding_box<3>(corners));
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    triangle_normals_.push_back(normal);
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
      edge_normals_[mesh_.triangle_edges()[t][i]] += normal;
      vertex_normals_[triangle[i]] += std::atan2(a.cross(b).norm(), a.dot(b)) * normal;
    }
  }
  bvh_ = Bvh(boxes);
}

std::optional<Hit> MeshSolid::find_hit(const Vec3& p) const {
  if (!bounds_.contains(p)) return {};
  ClosestPoint<3, 3> nearest;
  nearest.squared_distance = std::numeric_limits<double>::infinity();
  Index triangle = kNone;
  visit_nearest(bvh_.nodes(), enclosing_box<3>(p, p), std::numeric_limits<float>::infinity(), [&](Index t, float) {
    const auto& corners = mesh_.triangles()[t];
    const auto found =
        closest_point_on_triangle(p, positions_[corners[0]], positions_[corners[1]], positions_[corners[2]]);
    if (found.squared_distance < nearest.squared_distance) {
      nearest = found;
      triangle = t;
    }
    return round_up(nearest.squared_distance);
  });
  Vec3 normal = triangle_normals_[triangle];
  const int missing = std::countr_one(nearest.vertex_mask), only = std::countr_zero(nearest.vertex_mask);
  if (std::popcount(nearest.vertex_mask) == 2) normal = edge_normals_[mesh_.triangle_edges()[triangle][missing]];
  if (std::popcount(nearest.vertex_mask) == 1) normal = vertex_normals_[mesh_.triangles()[triangle][only]];
  const Vec3 way = nearest.point - p;
  const double depth = way.norm();
  if (!(way.dot(normal) > 0) || depth == 0) return {};
  return Hit{way / depth, depth};
}

}  // namespace selvage
