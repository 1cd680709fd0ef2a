#include "contact/closest_rules.h"

#include "bvh/traverse.h"
#include "core/parallel.h"
#include "mesh/simplex_corners.h"
#include "selvage/geometry/closest_point.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

namespace selvage {

namespace {

/// Step towards the middle of an element by which a point, rounded to lie outside, is inside again: far above rounding,
/// and too small to be seen.
constexpr double kInward = 1e-9;

/// Where a point is in an element, as weights of its vertices; nothing where that is flat.
std::optional<std::array<double, 4>> weights_in(const std::array<Vec3, 4>& corners, const Vec3& point) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).dot((c - a).cross(d - a));
  };
  const double whole = volume(corners[0], corners[1], corners[2], corners[3]);
  if (whole == 0) return {};
  std::array<double, 4> weights;
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    auto part = corners;
    part[i] = point;
    weights[i] = std::max(0.0, volume(part[0], part[1], part[2], part[3]) / whole);
    sum += weights[i];
  }
  for (double& weight : weights) weight = (1 - kInward) * weight / sum + kInward / 4;
  return weights;
}

std::array<double, 3> barycentric_of(const BoundaryPath<3>& path) {
  return {path.barycentric[0], path.barycentric[1], path.barycentric[2]};
}

}  // namespace

RestPoseRule::RestPoseRule(const TetMesh& mesh, std::span<const Vec3> rest_positions)
    : mesh_(mesh), rest_positions_(rest_positions.begin(), rest_positions.end()), finder_(mesh, rest_positions_) {}

std::vector<BoundaryPath<3>> RestPoseRule::find(std::span<const PathQuery<3>> queries,
                                                std::span<const Vec3> positions) const {
  std::vector<PathQuery<3>> at_rest(queries.begin(), queries.end());
  std::vector<std::uint8_t> is_flat(queries.size(), 0);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const auto& element = mesh_.elements()[queries[i].element];
    const auto weights = weights_in(corners_of(element, positions), queries[i].point);
    is_flat[i] = !weights;
    at_rest[i].point = Vec3::Zero();
    for (int k = 0; k < 4; ++k) at_rest[i].point += (weights ? (*weights)[k] : 0.25) * rest_positions_[element[k]];
  }
  std::vector<BoundaryPath<3>> paths = finder_.find_paths(at_rest);
  for (std::size_t i = 0; i < paths.size(); ++i) {
    BoundaryPath<3>& path = paths[i];
    if (is_flat[i]) path.status = PathStatus::kNoPath;
    if (path.status != PathStatus::kFound) continue;
    const auto corners = corners_of(mesh_.boundary_faces()[path.face], positions);
    path.point = path.barycentric[0] * corners[0] + path.barycentric[1] * corners[1] + path.barycentric[2] * corners[2];
    path.distance = (path.point - queries[i].point).norm();
    path.normal = outward_normal(mesh_, positions, path.face, barycentric_of(path));
  }
  return paths;
}

EuclideanRule::EuclideanRule(const TetMesh& mesh, std::span<const Index> vertex_objects)
    : mesh_(mesh), vertex_objects_(vertex_objects.begin(), vertex_objects.end()) {
  if (!vertex_objects_.empty()) return;
  vertex_objects_.assign(mesh.vertex_count(), kNone);
  const std::vector<Index> components = mesh.element_components();
  for (Index e = 0; e < mesh.element_count(); ++e)
    for (const Index v : mesh.elements()[e]) vertex_objects_[v] = components[e];
}

void EuclideanRule::place(std::span<const Vec3> positions) {
  std::vector<Box> boxes(mesh_.boundary_face_count());
  parallel_for(std::ssize(boxes), kGrain,
               [&](std::int64_t f) { boxes[f] = bounding_box<3>(corners_of(mesh_.boundary_faces()[f], positions)); });
  if (faces_.primitive_count() == mesh_.boundary_face_count()) {
    faces_.refit(boxes);
    if (faces_.quality_loss() <= Bvh::kRebuildAbove) return;
  }
  faces_ = Bvh(boxes);
}

bool EuclideanRule::applies_to(const PenetratingPoint& point) const {
  const Index vertex = point.vertices[0];
  return vertex >= std::ssize(vertex_objects_) || vertex_objects_[vertex] != object_of(point.query.element);
}

BoundaryPath<3> EuclideanRule::find(const PathQuery<3>& query, std::span<const Vec3> positions) const {
  const Index object = object_of(query.element);
  ClosestPoint<3, 3> closest;
  closest.squared_distance = HUGE_VAL;
  Index face = kNone;
  const auto visit = [&](Index f, float) {
    const auto& vertices = mesh_.boundary_faces()[f];
    if (vertex_objects_[vertices[0]] == object) {
      const auto [a, b, c] = corners_of(vertices, positions);
      const auto candidate = closest_point_on_triangle(query.point, a, b, c);
      const double known = closest.squared_distance;
      if (candidate.squared_distance < known || (candidate.squared_distance == known && f < face)) {
        closest = candidate;
        face = f;
      }
    }
    return round_up(closest.squared_distance);
  };
  visit_nearest(faces_.nodes(), enclosing_box<3>(query.point, query.point), HUGE_VALF, visit);

  BoundaryPath<3> path;
  if (face == kNone) return path;
  constexpr BoundaryFeature kFeatures[] = {BoundaryFeature::kVertex, BoundaryFeature::kEdge, BoundaryFeature::kFace};
  path.status = PathStatus::kFound;
  path.feature = kFeatures[std::popcount(closest.vertex_mask) - 1];
  path.face = face;
  path.barycentric = Vec3(closest.barycentric[0], closest.barycentric[1], closest.barycentric[2]);
  path.point = closest.point;
  path.distance = std::sqrt(closest.squared_distance);
  path.normal = outward_normal(mesh_, positions, face, closest.barycentric);
  return path;
}

}  // namespace selvage
