#include "scene/reading/touches.h"

#include "selvage/self_collision/proximity.h"
#include "simulation/colliders/prepared_collider.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

double touching_distance(const TriangleMesh& surface, std::span<const Vec3> positions) {
  double sum = 0;
  for (const auto& [a, b] : surface.edges()) sum += (positions[a] - positions[b]).norm();
  const double mean = sum / static_cast<double>(surface.edges().size());
  // A mesh in one point touches nothing, but distances must be positive.
  return mean > 0 ? TouchFinder::kNear * mean : 1e-300;
}

PlaneShape grow(const PlaneShape& plane, double by) {
  return {plane.point + by * plane.normal.normalized(), plane.normal};
}

BoxContainer grow(const BoxContainer& box, double by) {
  const Vec3 inset = (0.25 * (box.upper - box.lower)).cwiseMin(by);
  return {box.lower + inset, box.upper - inset};
}

/// Higher and narrower: the rim and the hollow both come nearer.
Bowl grow(const Bowl& bowl, double by) {
  return {bowl.centre + by * bowl.axis.normalized(), bowl.axis, std::max(bowl.radius - by, 0.5 * bowl.radius)};
}

SphereShape grow(const SphereShape& sphere, double by) {
  return {sphere.centre, sphere.radius + by};
}

CylinderShape grow(const CylinderShape& cylinder, double by) {
  return {cylinder.centre, cylinder.axis, cylinder.radius + by, cylinder.length + 2 * by};
}

MeshShape grow(const MeshShape& shape, double by) {
  // With vertices in the same place taken as one, so that the surface does not tear.
  const MeshCollider mesh("mesh", shape);
  std::vector<Vec3> normals(mesh.positions().size(), Vec3::Zero());
  MeshShape grown;
  for (const auto& triangle : mesh.mesh().triangles()) {
    const Vec3& p = mesh.positions()[triangle[0]];
    const Vec3 normal = (mesh.positions()[triangle[1]] - p).cross(mesh.positions()[triangle[2]] - p);
    for (const Index v : triangle) normals[static_cast<std::size_t>(v)] += normal;
    grown.triangles.push_back(triangle);
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    grown.positions.push_back(mesh.positions()[v] + by * normals[v].normalized());
  return grown;
}

KeyframedShape grow(const KeyframedShape& shape, double by) {
  KeyframedShape grown{shape.triangles, shape.times, {}};
  for (const auto& positions : shape.positions)
    grown.positions.push_back(grow(MeshShape{positions, shape.triangles}, by).positions);
  return grown;
}

std::vector<PreparedCollider> grow_all(std::span<const Collider> colliders, double by) {
  std::vector<Collider> grown(colliders.begin(), colliders.end());
  for (Collider& collider : grown)
    std::visit([&](const auto& shape) { collider.shape = grow(shape, by); }, Collider(collider).shape);
  return prepare_colliders(grown);
}

/// Of any length.
Vec3 face_normal(const TriangleMesh& surface, std::span<const Vec3> positions, Index face) {
  const auto& [a, b, c] = surface.triangles()[face];
  return (positions[b] - positions[a]).cross(positions[c] - positions[a]);
}

PairFilters without_neighbours() {
  PairFilters filters;
  filters.neighbour_rings = 1;
  return filters;
}

bool is_inner(double place) {
  return place > 0 && place < 1;
}

}  // namespace

struct TouchFinder::Impl {
  TriangleMesh surface;
  double distance;
  std::vector<PreparedCollider> grown;  ///< colliders, larger by the distance
  ProximityFinder near;

  Impl(TriangleMesh of, std::span<const Vec3> positions, std::span<const Collider> colliders)
      : surface(std::move(of)),
        distance(touching_distance(surface, positions)),
        grown(grow_all(colliders, distance)),
        near(surface, positions, distance, without_neighbours()) {}

  void add_collider_touches(std::span<const Vec3> positions, double time, std::vector<Touch>& touches);
  void add_body_touches(std::span<const Vec3> positions, std::vector<Touch>& touches);
};

TouchFinder::TouchFinder(const TetMesh& mesh, std::span<const Vec3> positions, std::span<const Collider> colliders)
    : TouchFinder(boundary_surface(mesh), positions, colliders) {}

TouchFinder::TouchFinder(TriangleMesh surface, std::span<const Vec3> positions, std::span<const Collider> colliders)
    : impl_(std::make_unique<Impl>(std::move(surface), positions, colliders)) {}

TouchFinder::~TouchFinder() = default;

double TouchFinder::distance() const {
  return impl_->distance;
}

void TouchFinder::Impl::add_collider_touches(std::span<const Vec3> positions, double time,
                                             std::vector<Touch>& touches) {
  std::vector<RigidTransform> places;
  for (PreparedCollider& collider : grown) {
    collider.set_step(time, time);
    places.push_back(collider.motion.at(time));
  }
  for (Index v = 0; v < surface.vertex_count(); ++v) {
    if (surface.vertex_triangles(v).empty()) continue;
    for (std::size_t i = 0; i < grown.size(); ++i) {
      const Vec3 p = places[i].invert(positions[v]);
      const auto hit = std::visit([&](const auto& shape) { return find_hit(shape, p); }, grown[i].shape);
      if (!hit) continue;
      touches.push_back({MarkKind::kCollider, {v, v}, 0, places[i].rotation * hit->normal});
      break;
    }
  }
}

void TouchFinder::Impl::add_body_touches(std::span<const Vec3> positions, std::vector<Touch>& touches) {
  near.update(positions);
  const NearPairs pairs = near.find_pairs();
  for (std::size_t i = 0; i < pairs.vertex_face.size();) {
    const Index vertex = pairs.vertex_face[i].vertex;
    const NearVertexFace* nearest = &pairs.vertex_face[i];
    for (; i < pairs.vertex_face.size() && pairs.vertex_face[i].vertex == vertex; ++i)
      if (pairs.vertex_face[i].distance < nearest->distance) nearest = &pairs.vertex_face[i];
    const Vec3 normal = face_normal(surface, positions, nearest->face);
    touches.push_back({MarkKind::kVertexFace, {vertex, vertex}, 0, normal.normalized()});
  }
  for (const NearEdges& pair : pairs.edge_edge) {
    if (!is_inner(pair.place[0]) || !is_inner(pair.place[1])) continue;
    const auto& first = surface.edges()[pair.first];
    const auto& second = surface.edges()[pair.second];
    Vec3 outward = Vec3::Zero();
    for (const Index face : surface.edge_triangles(pair.second)) outward += face_normal(surface, positions, face);
    Vec3 normal = (positions[first[1]] - positions[first[0]]).cross(positions[second[1]] - positions[second[0]]);
    if (normal.dot(outward) < 0) normal = -normal;
    if (!(normal.norm() > 0)) normal = outward;
    touches.push_back({MarkKind::kEdgeEdge, {first[0], first[1]}, pair.place[0], normal.normalized()});
  }
}

std::vector<Touch> TouchFinder::find(std::span<const Vec3> positions, double time) {
  std::vector<Touch> touches;
  impl_->add_collider_touches(positions, time, touches);
  impl_->add_body_touches(positions, touches);
  if (touches.size() > kMaxTouches) touches.resize(kMaxTouches);
  return touches;
}

}  // namespace selvage
