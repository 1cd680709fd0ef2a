#include "contact/ways_out/path_contact.h"

#include "contact/input/contact_weights.h"
#include "mesh/simplex_corners.h"

#include <algorithm>

namespace selvage {

PenetratingPoint penetrating_vertex(Index vertex, Index element, std::span<const Vec3> positions) {
  return {.kind = ContactKind::kVertexPath,
          .feature = vertex,
          .count = 1,
          .vertices = {vertex},
          .weights = {1},
          .query = PathQuery<3>::of_vertex(vertex, positions[vertex], element)};
}

PenetratingPoint penetrating_edge(Index edge, const VertexTuple<2>& vertices, double middle, Index element,
                                  std::span<const Vec3> positions) {
  const auto& [a, b] = vertices;
  const Vec3 point = positions[a] + middle * (positions[b] - positions[a]);
  return {.kind = ContactKind::kEdgePath,
          .feature = edge,
          .count = 2,
          .vertices = {a, b},
          .weights = {1 - middle, middle},
          .query = PathQuery<3>::of_edge(vertices, point, element)};
}

PenetratingPoint penetrating_centroid(Index of_element, const VertexTuple<4>& vertices, Index element,
                                      std::span<const Vec3> positions) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : vertices) sum += positions[v];
  return {.kind = ContactKind::kCentroidPath,
          .feature = of_element,
          .count = 4,
          .vertices = vertices,
          .weights = {0.25, 0.25, 0.25, 0.25},
          .query = PathQuery<3>::at(sum / 4, element)};
}

Contact path_contact(const TetMesh& mesh, const PenetratingPoint& point, const BoundaryPath<3>& path) {
  Contact contact;
  contact.kind = point.kind;
  for (int i = 0; i < point.count; ++i) add_weight(contact, point.vertices[i], point.weights[i]);
  const auto& face = mesh.boundary_faces()[path.face];
  for (int i = 0; i < 3; ++i) add_weight(contact, face[i], -path.barycentric[i]);
  remove_zero_weights(contact);
  contact.normal = path.normal;
  contact.point = path.point;
  contact.point_feature = point.feature;
  contact.surface_feature = path.face;
  return contact;
}

Contact collider_path_contact(const TetMesh& mesh, std::span<const Vec3> positions, const PenetratingPoint& point,
                              const BoundaryPath<3>& path) {
  Contact contact;
  contact.kind = point.kind;
  contact.point = path.point;
  contact.point_feature = point.feature;
  contact.surface_feature = path.face;
  const Vec3 way = path.point - point.query.point;
  contact.distance = way.norm();
  const auto& element = mesh.elements()[point.query.element];
  std::array<double, 4> barycentric{};
  double total = 0;
  for (int i = 0; i < 4; ++i) {
    const auto corners = corners_of(TetMesh::face_of(element, i), positions);
    barycentric[i] = std::max(0.0, area_normal(corners).dot(corners[0] - point.query.point));
    total += barycentric[i];
  }
  if (!(contact.distance > 0) || !(total > 0)) return contact;
  contact.normal = way / contact.distance;
  for (int i = 0; i < point.count; ++i) add_weight(contact, point.vertices[i], point.weights[i]);
  for (int i = 0; i < 4; ++i) add_weight(contact, element[i], -barycentric[i] / total);
  return contact;
}

Vec3 outward_normal(const TetMesh& mesh, std::span<const Vec3> positions, Index face,
                    const std::array<double, 3>& barycentric) {
  const auto& corners = mesh.boundary_faces()[face];
  const Vec3 own = area_normal(corners_of(corners, positions));
  Index first = kNone;
  for (int i = 0; i < 3; ++i)
    if (first == kNone && barycentric[i] != 0) first = corners[i];
  Vec3 sum = Vec3::Zero();
  double total = 0;
  for (const Index other : mesh.vertex_boundary_faces(first)) {
    const auto& others = mesh.boundary_faces()[other];
    bool has_all = true;
    for (int i = 0; i < 3; ++i)
      has_all &= barycentric[i] == 0 || std::find(others.begin(), others.end(), corners[i]) != others.end();
    if (!has_all) continue;
    const Vec3 part = area_normal(corners_of(others, positions));
    sum += part;
    total += part.norm();
  }
  const Vec3 normal = sum.norm() > 1e-12 * total ? sum : own;
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

}  // namespace selvage
