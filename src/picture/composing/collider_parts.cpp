#include "picture/composing/collider_parts.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace selvage {

namespace {

/// Part of the room's size by which the ground is drawn lower than it is.
constexpr double kBelow = 1e-3;

constexpr int kAround = 72, kRings = 24;  // facets of round shapes
constexpr double kPlateSize = 0.5;        // half the side of a plane, against the size of the room
constexpr double kWallRoom = 0.06;        // what a wall stands over its contents, against the size of the room
constexpr double kEdgeCosine = 0.94;      // edges of a mesh whose faces differ by more than 20 degrees are drawn

/// Two directions across `axis`, right-handed with it.
struct Axes {
  Vec3 u, v, axis;
  explicit Axes(const Vec3& along) : u(along.normalized().unitOrthogonal()), axis(along.normalized()) {
    v = axis.cross(u);
  }
  Vec3 around(double angle) const { return std::cos(angle) * u + std::sin(angle) * v; }
};

double angle_of(int i) {
  return 2 * std::numbers::pi * i / kAround;
}

struct Builder {
  ColliderPart part;
  const Room& room;
  double time = 0;  ///< [s]

  void add_quad(Index a, Index b, Index c, Index d) {
    part.triangles.push_back({a, b, c});
    part.triangles.push_back({a, c, d});
  }

  void add_circle(const Vec3& centre, double radius, const Axes& axes) {
    for (int i = 0; i < kAround; ++i)
      part.edges.push_back(
          {centre + radius * axes.around(angle_of(i)), centre + radius * axes.around(angle_of(i + 1))});
  }

  /// Rings of kAround vertices, one behind the other along the axis, joined outwards.
  void join_rings(int rings) {
    for (int r = 0; r + 1 < rings; ++r)
      for (int i = 0; i < kAround; ++i) {
        const Index a = r * kAround + i, b = r * kAround + (i + 1) % kAround;
        add_quad(a, b, b + kAround, a + kAround);
      }
  }

  /// A part of a sphere from one angle to another, measured from the tip of the axis opposite to it.
  void add_sphere(const Vec3& centre, double radius, const Axes& axes, double from, double to) {
    for (int r = 0; r <= kRings; ++r) {
      const double angle = from + (to - from) * r / kRings;
      for (int i = 0; i < kAround; ++i)
        part.positions.push_back(centre +
                                 radius * (std::sin(angle) * axes.around(angle_of(i)) - std::cos(angle) * axes.axis));
    }
    join_rings(kRings + 1);
  }

  void operator()(const PlaneShape& s) {
    const Vec3 normal = s.normal.normalized();
    Axes axes(normal);
    // Sides that run level, where there are any.
    if (const Vec3 level = room.up.cross(normal); level.norm() > 1e-3)
      axes.u = level.normalized(), axes.v = normal.cross(axes.u);
    const Vec3 middle = room.middle() - normal.dot(room.middle() - s.point) * normal;
    const double half = kPlateSize * room.size();
    for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
      part.positions.push_back(middle + half * (x * axes.u + y * axes.v));
    add_quad(0, 1, 2, 3);
    for (std::size_t i = 0; i < 4; ++i) part.edges.push_back({part.positions[i], part.positions[(i + 1) % 4]});
    part.free_side = normal;
  }

  void operator()(const BoxContainer& s) {
    const Vec3 spare = Vec3::Constant(kWallRoom * room.size());
    const Vec3 lower = s.lower.cwiseMin(s.upper).cwiseMax(room.lower - 4 * spare);
    const Vec3 upper = s.upper.cwiseMax(s.lower).cwiseMin(room.upper + spare).cwiseMax(lower);
    for (int i = 0; i < 8; ++i)
      part.positions.push_back({(i & 1 ? upper : lower)[0], (i & 2 ? upper : lower)[1], (i & 4 ? upper : lower)[2]});
    // Normals point inwards.
    add_quad(0, 1, 3, 2), add_quad(4, 6, 7, 5), add_quad(0, 4, 5, 1);
    add_quad(2, 3, 7, 6), add_quad(0, 2, 6, 4), add_quad(1, 5, 7, 3);
    // A face that has been brought nearer is open: there is no wall.
    std::vector<VertexTuple<3>> walls;
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      const auto& [a, b, c] = part.triangles[t];
      const Vec3 &p = part.positions[a], &q = part.positions[b], &r = part.positions[c];
      bool open = false;
      for (int axis = 0; axis < 3; ++axis) {
        const bool across = p[axis] == q[axis] && p[axis] == r[axis];
        open = open || (across && p[axis] != s.lower[axis] && p[axis] != s.upper[axis]);
      }
      if (!open) walls.push_back(part.triangles[t]);
    }
    part.triangles = std::move(walls);
    for (int i = 0; i < 8; ++i)
      for (const int bit : {1, 2, 4})
        if (!(i & bit)) part.edges.push_back({part.positions[i], part.positions[i | bit]});
    part.one_sided = true;
  }

  void operator()(const Bowl& s) {
    const Axes axes(s.axis);
    add_sphere(s.centre, s.radius, axes, 0, std::numbers::pi / 2);
    for (auto& t : part.triangles) std::swap(t[1], t[2]);  // seen from inside
    add_circle(s.centre, s.radius, axes);
    part.one_sided = true;
  }

  void operator()(const SphereShape& s) {
    add_sphere(s.centre, s.radius, Axes(Vec3::UnitZ()), 0, std::numbers::pi);
    part.casts_shadow = true;
  }

  void operator()(const CylinderShape& s) {
    const Axes axes(s.axis);
    for (const double end : {-0.5, 0.5}) {
      const Vec3 middle = s.centre + end * s.length * axes.axis;
      for (int i = 0; i < kAround; ++i) part.positions.push_back(middle + s.radius * axes.around(angle_of(i)));
      add_circle(middle, s.radius, axes);
    }
    join_rings(2);
    for (const int end : {0, 1}) {
      const auto middle = static_cast<Index>(part.positions.size());
      part.positions.push_back(s.centre + (end - 0.5) * s.length * axes.axis);
      for (Index i = 0; i < kAround; ++i) {
        const Index a = end * kAround + i, b = end * kAround + (i + 1) % kAround;
        part.triangles.push_back(end == 1 ? VertexTuple<3>{middle, a, b} : VertexTuple<3>{middle, b, a});
      }
    }
    part.casts_shadow = true;
  }

  void operator()(const MeshShape& s) {
    part.positions = s.positions;
    part.triangles = s.triangles;
    part.casts_shadow = true;
    const auto normal = [&](const VertexTuple<3>& t) {
      return (s.positions[t[1]] - s.positions[t[0]]).cross(s.positions[t[2]] - s.positions[t[0]]).normalized();
    };
    // Edges by their ends' places: in STL no two triangles share a vertex.
    const auto less = [](const Vec3& a, const Vec3& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    const auto edge_less = [&](const std::array<Vec3, 2>& a, const std::array<Vec3, 2>& b) {
      return less(a[0], b[0]) || (a[0] == b[0] && less(a[1], b[1]));
    };
    std::map<std::array<Vec3, 2>, std::vector<Vec3>, decltype(edge_less)> faces(edge_less);
    for (const auto& t : s.triangles)
      for (std::size_t i = 0; i < 3; ++i) {
        std::array<Vec3, 2> edge{s.positions[t[i]], s.positions[t[(i + 1) % 3]]};
        if (less(edge[1], edge[0])) std::swap(edge[0], edge[1]);
        faces[edge].push_back(normal(t));
      }
    for (const auto& [edge, normals] : faces)
      if (normals.size() != 2 || normals[0].dot(normals[1]) < kEdgeCosine) part.edges.push_back(edge);
  }

  void operator()(const KeyframedShape& s) { (*this)(s.at(time)); }
};

}  // namespace

ColliderPart make_collider_part(const Collider& collider, double time, const Room& room) {
  Builder builder{{}, room, time};
  std::visit(builder, collider.shape);
  ColliderPart& part = builder.part;
  const RigidTransform place = collider.motion.at(time);
  for (Vec3& p : part.positions) p = place(p);
  for (auto& edge : part.edges)
    for (Vec3& p : edge) p = place(p);
  if (part.free_side) part.free_side = place.rotation * *part.free_side;
  return std::move(part);
}

Ground find_ground(std::span<const Collider> colliders, const Room& room) {
  double lowest = INFINITY, highest = -INFINITY;
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1 ? room.upper : room.lower)[0], (i & 2 ? room.upper : room.lower)[1],
                      (i & 4 ? room.upper : room.lower)[2]);
    lowest = std::min(lowest, room.up.dot(corner));
    highest = std::max(highest, room.up.dot(corner));
  }
  std::optional<Ground> ground;
  for (std::size_t i = 0; i < colliders.size(); ++i) {
    if (!colliders[i].motion.keyframes.empty()) continue;
    Ground found{0, {}, false};
    if (const auto* plane = std::get_if<PlaneShape>(&colliders[i].shape)) {
      if (plane->normal.normalized().dot(room.up) < 0.999) continue;
      found = {plane->point.dot(room.up), i, false};
    } else if (const auto* box = std::get_if<BoxContainer>(&colliders[i].shape)) {
      found = {std::min(box->lower.dot(room.up), box->upper.dot(room.up)), {}, true};
    } else {
      continue;
    }
    if (found.height < highest && (!ground || found.height > ground->height)) ground = found;
  }
  if (!ground) return {lowest, {}, false};
  // Cloth that lies on the ground is seen, not the ground in it.
  ground->height -= kBelow * (room.upper - room.lower).norm();
  return *ground;
}

}  // namespace selvage
