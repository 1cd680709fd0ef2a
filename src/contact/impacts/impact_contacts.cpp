#include "contact/impacts/impact_contacts.h"

#include "contact/input/contact_weights.h"
#include "mesh/simplex_corners.h"
#include "selvage/geometry/closest_point.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Sine below which a triangle counts as flat, edges as parallel, a motion as grazing: rounding.
constexpr double kFlat = 1e-10;
/// Sine above which a triangle rises through a contact's plane, and not only bends or rounds to the other side.
constexpr double kSteep = 0.5;
/// Sine of the angle between a motion and cloth up to which the cloth's normal says little of where it came from.
constexpr double kAlong = 0.01;

template <std::size_t N>
struct MovingSimplex {
  std::array<Vec3, N> t0, velocity, at;  ///< at the time of impact

  MovingSimplex(const SurfaceStep& step, const std::array<Index, N>& vertices, double time) {
    for (std::size_t i = 0; i < N; ++i) {
      const Vec3 &x0 = step.positions_t0[vertices[i]], &x1 = step.positions_t1[vertices[i]];
      t0[i] = x0;
      velocity[i] = x1 - x0;
      at[i] = (1 - time) * x0 + time * x1;
    }
  }
};

template <std::size_t N>
Vec3 weighted(const std::array<Vec3, N>& points, const std::array<double, N>& weights) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < N; ++i) sum += weights[i] * points[i];
  return sum;
}

/// Turns a unit normal against the approach; leaves it where the approach is across it but for rounding.
Vec3 against(const Vec3& normal, const Vec3& approach) {
  const double along = normal.dot(approach);
  return along > kFlat * approach.norm() ? Vec3(-normal) : normal;
}

std::optional<Vec3> direction(const Vec3& x) {
  const double length = x.norm();
  if (!(length > 0)) return {};
  return Vec3(x / length);
}

/// Sum of the outward area normals of an edge's triangles.
Vec3 outer_side(const SurfaceStep& step, Index edge, double time) {
  Vec3 sum = Vec3::Zero();
  if (step.is_cloth(step.surface.edge_triangles(edge))) return sum;
  for (const Index t : step.surface.edge_triangles(edge))
    sum += area_normal(MovingSimplex<3>(step, step.surface.triangles()[t], time).at);
  return sum;
}

/// The normal along which a contact can push on a surface: the given one where the triangles around are all behind its
/// plane; where one rises steeply through it, the closest of the triangles' own normals. A body that slides on a flat
/// one and is pressed a little into it seems to run with its side into edges and vertices of the flat. Its triangles
/// rise through the plane: with their normals it is lifted off, not stopped.
Vec3 fit_to_surface(const SurfaceStep& step, std::span<const Index> triangles, double time, const Vec3& point,
                    const Vec3& normal) {
  if (step.is_cloth(triangles)) return normal;
  bool rises = false;
  double closest = -2;
  Vec3 fitting = normal;
  for (const Index t : triangles) {
    const MovingSimplex<3> triangle(step, step.surface.triangles()[t], time);
    for (const Vec3& corner : triangle.at) rises |= normal.dot(corner - point) > kSteep * (corner - point).norm();
    const std::optional<Vec3> own = direction(area_normal(triangle.at));
    if (!own || own->dot(normal) <= closest) continue;
    closest = own->dot(normal);
    fitting = *own;
  }
  return rises ? fitting : normal;
}

/// Depth of triangles in front of a plane [m].
double depth_through(const SurfaceStep& step, std::span<const Index> triangles, double time, const Vec3& point,
                     const Vec3& normal) {
  double depth = 0;
  for (const Index t : triangles)
    for (const Vec3& corner : MovingSimplex<3>(step, step.surface.triangles()[t], time).at)
      depth = std::max(depth, normal.dot(corner - point));
  return depth;
}

/// The normal of two edges, fitted to the triangles of both. Where the normal that fits one does not fit the other, one
/// of them was pressed a little into the other before: the one that is in less deep is lifted off.
Vec3 fit_to_edges(const SurfaceStep& step, EdgeEdgePair pair, double time, const Vec3& point, const Vec3& normal) {
  const auto first = step.surface.edge_triangles(pair.first), second = step.surface.edge_triangles(pair.second);
  const Vec3 fits_second = fit_to_surface(step, second, time, point, normal);
  const Vec3 fits_first = -fit_to_surface(step, first, time, point, -fits_second);
  if (fits_second == normal || fits_first == fits_second) return fits_first;
  const bool second_in_deeper =
      depth_through(step, second, time, point, fits_first) > depth_through(step, first, time, point, -fits_second);
  return second_in_deeper ? fits_second : fits_first;
}

/// The normal of a contact with cloth: where it is met along itself, the direction in which the two stood at the start.
std::optional<Vec3> normal_of_cloth(const Vec3& normal, const Vec3& approach, const Vec3& offset_t0) {
  if (std::abs(normal.dot(approach)) > kAlong * approach.norm()) return normal;
  const std::optional<Vec3> from_start = direction(offset_t0);
  return from_start ? from_start : normal;
}

}  // namespace

std::array<double, 2> closest_places(const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
  const Vec3 u = a[1] - a[0], v = b[1] - b[0], w = a[0] - b[0];
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const auto place = [](double numerator, double denominator) {
    return denominator > 0 ? std::clamp(numerator / denominator, 0.0, 1.0) : 0.0;
  };
  double s = place(uv * vw - vv * uw, uu * vv - uv * uv);
  const double t = place(uv * s + vw, vv);
  s = place(uv * t - uw, uu);
  return {s, t};
}

std::optional<Contact> vertex_face_contact(const SurfaceStep& step, VertexFacePair pair, double time) {
  const auto& face = step.surface.triangles()[pair.face];
  const MovingSimplex<1> vertex(step, {pair.vertex}, time);
  const MovingSimplex<3> triangle(step, face, time);
  const auto closest = closest_point_on_triangle(vertex.at[0], triangle.at[0], triangle.at[1], triangle.at[2]);

  const Vec3 area = area_normal(triangle.at);
  const double longest =
      std::max((triangle.at[1] - triangle.at[0]).squaredNorm(), (triangle.at[2] - triangle.at[0]).squaredNorm());
  std::optional<Vec3> normal;
  if (area.norm() > kFlat * longest) {
    normal = direction(area);
    const Vec3 approach = vertex.velocity[0] - weighted(triangle.velocity, closest.barycentric);
    if (normal && time > 0) {
      normal = against(*normal, approach);
      const auto around = step.surface.vertex_triangles(pair.vertex);
      normal = -fit_to_surface(step, around, time, vertex.at[0], -*normal);
      normal = against(*normal, approach);
      if (step.is_cloth(pair.face) || step.is_cloth(around))
        normal = normal_of_cloth(*normal, approach, vertex.t0[0] - weighted(triangle.t0, closest.barycentric));
    }
  } else {
    normal = direction(vertex.t0[0] - weighted(triangle.t0, closest.barycentric));
  }
  if (!normal) return {};

  Contact contact;
  contact.kind = ContactKind::kVertexFace;
  add_weight(contact, pair.vertex, 1);
  for (int i = 0; i < 3; ++i) add_weight(contact, face[i], -closest.barycentric[i]);
  contact.normal = *normal;
  contact.point = closest.point;
  contact.time = time;
  contact.point_feature = pair.vertex;
  contact.surface_feature = pair.face;
  return contact;
}

std::optional<Contact> edge_edge_contact(const SurfaceStep& step, EdgeEdgePair pair, double time) {
  const auto &a = step.surface.edges()[pair.first], &b = step.surface.edges()[pair.second];
  const MovingSimplex<2> first(step, a, time), second(step, b, time);
  const auto [s, t] = closest_places(first.at, second.at);
  const std::array<double, 2> of_first{1 - s, s}, of_second{1 - t, t};

  const Vec3 u = first.at[1] - first.at[0], v = second.at[1] - second.at[0], across = u.cross(v);
  std::optional<Vec3> normal;
  if (across.norm() > kFlat * u.norm() * v.norm()) {
    normal = direction(across);
    // The outer side, as for a vertex and a face: it stays where there is no approach.
    if (normal && normal->dot(outer_side(step, pair.second, time) - outer_side(step, pair.first, time)) < 0)
      normal = -*normal;
    const Vec3 approach = weighted(first.velocity, of_first) - weighted(second.velocity, of_second);
    if (normal && time > 0) {
      normal = against(*normal, approach);
      normal = fit_to_edges(step, pair, time, weighted(second.at, of_second), *normal);
      normal = against(*normal, approach);
      if (step.is_cloth(step.surface.edge_triangles(pair.first)) ||
          step.is_cloth(step.surface.edge_triangles(pair.second)))
        normal = normal_of_cloth(*normal, approach, weighted(first.t0, of_first) - weighted(second.t0, of_second));
    }
  } else {
    normal = direction(weighted(first.t0, of_first) - weighted(second.t0, of_second));
  }
  if (!normal) return {};

  Contact contact;
  contact.kind = ContactKind::kEdgeEdge;
  for (int i = 0; i < 2; ++i) add_weight(contact, a[i], of_first[i]);
  for (int i = 0; i < 2; ++i) add_weight(contact, b[i], -of_second[i]);
  contact.normal = *normal;
  contact.point = weighted(second.at, of_second);
  contact.time = time;
  contact.point_feature = pair.first;
  contact.surface_feature = pair.second;
  return contact;
}

std::vector<Index> first_impacts(std::span<const VertexFacePair> pairs, std::span<const double> times) {
  std::vector<Index> kept;
  for (Index i = 0; i < std::ssize(pairs); ++i) {
    if (kept.empty() || pairs[kept.back()].vertex != pairs[i].vertex) {
      kept.push_back(i);
    } else if (times[i] < times[kept.back()]) {
      kept.back() = i;
    }
  }
  return kept;
}

std::vector<Index> first_impacts(std::span<const EdgeEdgePair> pairs, std::span<const double> times, Index edge_count) {
  std::vector<Index> earliest(edge_count, kNone);
  for (Index i = 0; i < std::ssize(pairs); ++i)
    for (const Index edge : {pairs[i].first, pairs[i].second})
      if (earliest[edge] == kNone || times[i] < times[earliest[edge]]) earliest[edge] = i;
  std::vector<Index> kept;
  for (Index i = 0; i < std::ssize(pairs); ++i)
    if (earliest[pairs[i].first] == i || earliest[pairs[i].second] == i) kept.push_back(i);
  return kept;
}

}  // namespace selvage
