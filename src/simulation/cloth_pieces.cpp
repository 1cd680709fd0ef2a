#include "simulation/cloth_pieces.h"

#include "elasticity/triangles/rest_triangle.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Angle at rest up to which a hinge counts as flat [rad].
constexpr double kFlatHinge = 1e-6;

/// The first triangle as (edge, across), the second as (edge turned, across).
VertexTuple<4> hinge_vertices(const VertexTuple<3>& first, const VertexTuple<3>& second) {
  const auto is_of = [](const VertexTuple<3>& triangle, Index v) {
    return std::find(triangle.begin(), triangle.end(), v) != triangle.end();
  };
  int across = 0;
  while (across < 2 && is_of(second, first[across])) ++across;
  Index other = second[0];
  for (const Index v : second)
    if (!is_of(first, v)) other = v;
  return {first[(across + 1) % 3], first[(across + 2) % 3], first[across], other};
}

}  // namespace

std::vector<ClothTriangle> list_cloth_triangles(const Model& model) {
  std::vector<ClothTriangle> triangles;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const Body& body = model.bodies[b];
    for (Index t = body.first_triangle; t < body.first_triangle + body.triangle_count; ++t)
      triangles.push_back({model.triangles[t], static_cast<Index>(b),
                           rest_triangle(gather(model.triangles[t], model.rest_positions), body.cloth.warp_direction)});
  }
  return triangles;
}

std::vector<ClothHinge> list_cloth_hinges(const Model& model) {
  std::vector<ClothHinge> hinges;
  if (model.triangles.empty()) return hinges;
  std::vector<Index> body_of(model.triangles.size(), kNone);
  for (std::size_t b = 0; b < model.bodies.size(); ++b)
    std::fill_n(body_of.begin() + model.bodies[b].first_triangle, model.bodies[b].triangle_count,
                static_cast<Index>(b));
  const TriangleMesh cloth(model.mesh.vertex_count(), model.triangles);
  for (Index e = 0; e < cloth.edge_count(); ++e) {
    const auto around = cloth.edge_triangles(e);
    for (std::size_t k = 1; k < around.size(); ++k) {
      const Index body = body_of[around[k]];
      const double stiffness = model.bodies[body].cloth.bending;
      const VertexTuple<4> vertices = hinge_vertices(model.triangles[around[k - 1]], model.triangles[around[k]]);
      const bool is_doubled = std::find(vertices.begin(), vertices.begin() + 3, vertices[3]) != vertices.begin() + 3;
      if (!(stiffness > 0) || body != body_of[around[k - 1]] || is_doubled) continue;
      const HingePositions rest = gather(vertices, model.rest_positions);
      ClothHinge hinge{.vertices = vertices,
                       .body = body,
                       .is_flat = std::abs(hinge_angle(rest)) <= kFlatHinge,
                       .flat = QuadraticBending::of(rest, stiffness),
                       .bent = HingeBending::of(rest, stiffness)};
      hinges.push_back(hinge);
    }
  }
  return hinges;
}

std::vector<double> half_thickness_of(const Model& model) {
  std::vector<double> thickness;
  for (const Body& body : model.bodies) {
    if (!body.is_cloth() || !(body.cloth.thickness > 0)) continue;
    thickness.resize(model.mesh.vertex_count(), 0.0);
    std::fill_n(thickness.begin() + body.first_vertex, body.vertex_count, body.cloth.thickness / 2);
  }
  return thickness;
}

}  // namespace selvage
