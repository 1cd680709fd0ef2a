#include "simulation/time_step/draw_off.h"

#include "mesh/position_extent.h"
#include "simulation/colliders/passage.h"

#include <algorithm>

namespace selvage {

namespace {

/// Cosine between a way and the way out of a collider below which what meets on it is no touch, nor a slide along.
constexpr double kAgainst = -0.3;

/// Whether a vertex that is outside of a collider runs into it on a straight way.
/// @param least_depth  what is less deep touches it [m]
bool is_in_way(const PreparedCollider& collider, double time, const Vec3& from, const Vec3& way, double least_depth) {
  const RigidTransform place = collider.motion.at(time);
  const Vec3 start = place.invert(from), end = place.invert(from + way);
  Eigen::AlignedBox3d box(start);
  box.extend(end);
  const std::optional<Hit> hit = std::visit(
      [&](const auto& shape) -> std::optional<Hit> {
        if (is_clear(shape, box) || find_hit(shape, start)) return {};
        return find_hit_on_way(shape, start, end);
      },
      collider.shape);
  return hit && hit->depth > least_depth && (place.rotation * hit->normal).dot(way) < kAgainst * way.norm();
}

/// Whether a point is inside a collider.
bool is_inside(const PreparedCollider& collider, double time, const Vec3& point) {
  const Vec3 p = collider.motion.at(time).invert(point);
  return std::visit([&](const auto& shape) { return find_hit(shape, p).has_value(); }, collider.shape);
}

/// Whether a vertex runs into a collider, and is not held between that and another one: then it is pulled along.
/// @param gap  what is nearer touches, and what is less deep [m]
bool is_stopped(std::span<const PreparedCollider> colliders, double time, const Vec3& from, const Vec3& way,
                double gap) {
  const Vec3 back = from - 2 * gap * way.normalized();
  return std::any_of(colliders.begin(), colliders.end(), [&](const PreparedCollider& collider) {
    return is_in_way(collider, time, from, way, gap) &&
           std::none_of(colliders.begin(), colliders.end(), [&](const PreparedCollider& other) {
             return &other != &collider && is_inside(other, time, back);
           });
  });
}

struct Any {
  bool value = false;
  void add(const Any& other) { value |= other.value; }
};

template <typename Predicate>
bool any_vertex(Index count, Predicate&& predicate) {
  return parallel_reduce<Any>(count, kGrain,
                              [&](std::int64_t first, std::int64_t last, Any& any) {
                                for (std::int64_t v = first; v < last && !any.value; ++v)
                                  any.value = predicate(static_cast<Index>(v));
                              })
      .value;
}

/// Points of colliders' faces at the start of a step that lie in the box around all bodies.
std::vector<ColliderPoint> points_near(const Model& model, std::span<const PreparedCollider> colliders,
                                       const ColliderSurface& surface, const Step& step) {
  std::vector<ColliderPoint> points;
  if (surface.face_points.empty()) return points;
  const PositionExtent<3> extent = extent_of<3>(step.positions.first(model.mesh.vertex_count()));
  const Eigen::AlignedBox3d box(extent.lower, extent.upper);
  std::vector<RigidTransform> places;
  for (const PreparedCollider& collider : colliders) places.push_back(collider.motion.at(step.start_time));
  for (const auto& [position, vertex] : surface.face_points)
    if (const Vec3 p = places[surface.collider_of_vertices[vertex]](position); box.contains(p))
      points.push_back({p, model.mesh.vertex_count() + vertex});
  return points;
}

/// What takes from a piece its mean motion against a direction.
Vec3 against(std::span<const StepVertex> vertices, const Step& step, const Pieces& pieces, Index piece,
             const Vec3& direction) {
  double sum = 0, mass = 0;
  for (Index v = 0; v < std::ssize(vertices); ++v) {
    if (pieces.of_vertex(v) != piece) continue;
    sum += (position(vertices[v]) - step.positions[v]).dot(direction) / vertices[v].inverse_mass;
    mass += 1 / vertices[v].inverse_mass;
  }
  return std::max(-sum / mass, 0.0) * direction;
}

}  // namespace

void DrawOff::begin(ContactFinder& finder, const Model& model, const Pieces& pieces,
                    std::span<const PreparedCollider> colliders, const ColliderSurface& surface, const Step& step,
                    std::span<const double> max_corrections, std::span<StepVertex> vertices) {
  drawn_.clear();
  ways_.clear();
  ways_off_edges_.clear();
  const auto count = static_cast<Index>(vertices.size());
  const auto is_held = [&](Index piece) {
    return any_vertex(count, [&](Index v) { return pieces.of_vertex(v) == piece && !(vertices[v].inverse_mass > 0); });
  };
  const auto is_blocked = [&](Index of_piece, const Vec3& way) {
    const Index piece = pieces.of_vertex(of_piece);
    return !is_held(piece) && any_vertex(count, [&](Index v) {
      return pieces.of_vertex(v) == piece && !model.mesh.vertex_boundary_faces(v).empty() &&
             is_stopped(colliders, step.start_time, step.positions[v], way, kContactGap * max_corrections[v]);
    });
  };
  for (const PieceWayOff& off : finder.choose_ways_off(is_blocked, points_near(model, colliders, surface, step))) {
    const Index piece = pieces.of_vertex(off.vertex);
    if (is_held(piece)) continue;
    double length = off.way;
    for (Index v = 0; v < count; ++v)
      if (pieces.of_vertex(v) == piece) length = std::min(length, kOffCollider * max_corrections[v]);
    drawn_.push_back(off.vertex);
    ways_.resize(vertices.size(), Vec3::Zero());
    ways_off_edges_.resize(vertices.size(), Vec3::Zero());
    // Contacts hold it else.
    const Vec3 hold = off.is_through ? against(vertices, step, pieces, piece, off.direction) : Vec3(Vec3::Zero());
    for (Index v = 0; v < count; ++v) {
      if (pieces.of_vertex(v) != piece) continue;
      ways_[v] = length * off.direction;
      if (!off.is_through) ways_off_edges_[v] = ways_[v];
      position(vertices[v]) += ways_[v] + hold;
    }
  }
}

}  // namespace selvage
