#include "simulation/crossings/collider_crossings.h"

#include "core/parallel.h"
#include "selvage/geometry/predicates.h"
#include "simulation/colliders/prepared_collider.h"
#include "simulation/colliders/sample_face.h"

#include <algorithm>
#include <optional>

namespace selvage {

namespace {

/// Spacing of a collider's points over the cell of the body that they are looked for in.
constexpr double kSpacing = 0.25;
/// The same of its faces, of which far more are beside a body than are ever in one.
constexpr double kSpacingOnFaces = 1;

/// A box around a box that is moved back to the coordinates of a collider.
Eigen::AlignedBox3d to_local(const Eigen::AlignedBox3d& box, const RigidTransform& place) {
  Eigen::AlignedBox3d local;
  for (int corner = 0; corner < 8; ++corner)
    local.extend(place.invert(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
  return local;
}

/// Boundary faces that hold the point of some queries, which are all its elements.
std::vector<VertexTuple<3>> faces_at(const Model& model, std::span<const PathQuery<3>> queries,
                                     std::span<const Vec3> positions) {
  std::vector<VertexTuple<3>> faces;
  for (const PathQuery<3>& query : queries)
    for (int i = 0; i < 4; ++i) {
      if (model.mesh.neighbours()[query.element][i].exists()) continue;
      const VertexTuple<3> face = TetMesh::face_of(model.mesh.elements()[query.element], i);
      if (orientation({positions[face[0]], positions[face[1]], positions[face[2]], query.point}) == 0)
        faces.push_back(face);
    }
  return faces;
}

bool is_mesh(const Collider& collider) {
  return std::holds_alternative<MeshShape>(collider.shape) || std::holds_alternative<KeyframedShape>(collider.shape);
}

bool share_a_vertex(const VertexTuple<3>& face, const VertexTuple<4>& element) {
  return std::ranges::find_first_of(face, element) != face.end();
}

}  // namespace

void ColliderCrossings::add(const ColliderCrossings& other) {
  vertices += other.vertices;
  points += other.points;
  deepest_vertex = std::max(deepest_vertex, other.deepest_vertex);
  deepest_point = std::max(deepest_point, other.deepest_point);
  // What is inside may have no depth: where no way leads out.
  if (other.any() && (body == kNone || other.deepest_in_cells > deepest_in_cells)) body = other.body;
  deepest_in_cells = std::max(deepest_in_cells, other.deepest_in_cells);
}

/// A state as it is measured.
struct ColliderCrossingFinder::Pose {
  Pose(const Model& model, std::span<const Collider> colliders, std::span<const Handle> handles, const State& state)
      : positions(state.positions), is_held(state.positions.size()) {
    for (const Handle& handle : handles)
      if (state.time < handle.release_time)
        for (const Index v : handle.vertices) is_held[static_cast<std::size_t>(v)] = 1;
    for (const Body& body : model.bodies) {
      Eigen::AlignedBox3d& box = boxes.emplace_back();
      for (Index v = body.first_vertex; v < body.first_vertex + body.vertex_count; ++v) box.extend(positions[v]);
    }
    for (const Collider& collider : colliders) places.push_back(collider.motion.at(state.time));
  }

  bool holds(const VertexTuple<4>& element) const {
    return std::ranges::all_of(element, [&](Index v) { return is_held[static_cast<std::size_t>(v)] != 0; });
  }

  std::span<const Vec3> positions;
  std::vector<std::uint8_t> is_held;       ///< vertices
  std::vector<Eigen::AlignedBox3d> boxes;  ///< of the bodies
  std::vector<RigidTransform> places;      ///< of the colliders
};

/// A point of a collider, to be looked for in one body.
struct ColliderCrossingFinder::Sample {
  Vec3 point;
  std::size_t collider, body;
};

ColliderCrossingFinder::ColliderCrossingFinder(const Model& model, std::span<const Collider> colliders,
                                               std::span<const Handle> handles)
    : model_(&model), colliders_(colliders), handles_(handles) {
  for (const Collider& collider : colliders) {
    parts_.push_back(prepare_colliders({&collider, 1}));
    mesh_features_.push_back(is_mesh(collider) ? find_features(collider, 0) : ColliderFeatures());
  }
  for (const Body& body : model.bodies) cells_.push_back(mean_edge_of(model, body));
}

ColliderCrossingFinder::~ColliderCrossingFinder() = default;
ColliderCrossingFinder::ColliderCrossingFinder(ColliderCrossingFinder&&) noexcept = default;
ColliderCrossingFinder& ColliderCrossingFinder::operator=(ColliderCrossingFinder&&) noexcept = default;

std::vector<ColliderCrossings> ColliderCrossingFinder::measure(const BoundaryPathFinder<3>& finder,
                                                               const State& state) {
  return measure_with(state, [&]() -> const BoundaryPathFinder<3>& { return finder; });
}

std::vector<ColliderCrossings> ColliderCrossingFinder::measure(const State& state) {
  std::optional<BoundaryPathFinder<3>> finder;
  return measure_with(state,
                      [&]() -> const BoundaryPathFinder<3>& { return finder.emplace(model_->mesh, state.positions); });
}

template <typename MakeFinder>
std::vector<ColliderCrossings> ColliderCrossingFinder::measure_with(const State& state, MakeFinder&& make_finder) {
  std::vector<ColliderCrossings> results(colliders_.size());
  if (colliders_.empty()) return results;
  place_keyframed(state.time);
  const Pose pose(*model_, colliders_, handles_, state);
  std::vector<Sample> samples;
  for (std::size_t c = 0; c < colliders_.size(); ++c)
    for (std::size_t b = 0; b < model_->bodies.size(); ++b) {
      measure_vertices(c, b, pose, results[c]);
      sample_points(c, b, pose, samples);
    }
  if (!samples.empty()) measure_points(make_finder(), pose, samples, results);
  return results;
}

/// Key-framed colliders come to where they are at a time.
void ColliderCrossingFinder::place_keyframed(double time) {
  for (std::size_t c = 0; c < colliders_.size(); ++c) {
    const auto* keyframed = std::get_if<KeyframedShape>(&colliders_[c].shape);
    if (keyframed == nullptr) continue;
    parts_[c].front().set_step(time, time);
    mesh_features_[c] = find_features({keyframed->at(time)}, 0);
  }
}

void ColliderCrossingFinder::measure_vertices(std::size_t collider, std::size_t body, const Pose& pose,
                                              ColliderCrossings& result) const {
  const Body& range = model_->bodies[body];
  const RigidTransform& place = pose.places[collider];
  const Eigen::AlignedBox3d box = to_local(pose.boxes[body], place);
  std::vector<const PreparedCollider*> near;
  for (const PreparedCollider& part : parts_[collider])
    if (!std::visit([&](const auto& shape) { return is_clear(shape, box); }, part.shape)) near.push_back(&part);
  if (near.empty()) return;
  const double cell = cells_[body];
  result.add(parallel_reduce<ColliderCrossings>(
      range.vertex_count, kGrain, [&](std::int64_t first, std::int64_t last, ColliderCrossings& piece) {
        for (std::int64_t v = range.first_vertex + first; v < range.first_vertex + last; ++v) {
          if (pose.is_held[v]) continue;
          const Vec3 own = place.invert(pose.positions[v]);
          double depth = 0;
          for (const PreparedCollider* part : near) {
            const auto hit = std::visit([&](const auto& shape) { return find_hit(shape, own); }, part->shape);
            if (hit) depth = std::max(depth, hit->depth);
          }
          piece.add({depth > kMinCrossing * cell, depth, 0, 0, depth / cell, static_cast<Index>(body)});
        }
      }));
}

void ColliderCrossingFinder::sample_points(std::size_t collider, std::size_t body, const Pose& pose,
                                           std::vector<Sample>& samples) const {
  const double spacing = kSpacing * cells_[body], face_spacing = kSpacingOnFaces * cells_[body];
  const bool has_mesh = is_mesh(colliders_[collider]);
  const ColliderFeatures made = has_mesh ? ColliderFeatures() : find_features(colliders_[collider], spacing);
  const ColliderFeatures& features = has_mesh ? mesh_features_[collider] : made;
  const RigidTransform& place = pose.places[collider];
  const Eigen::AlignedBox3d& box = pose.boxes[body];
  const auto keep = [&](const Vec3& point) {
    if (box.contains(point)) samples.push_back({point, collider, body});
  };
  for (const Vec3& point : features.points) keep(place(point));
  for (ColliderCurve curve : features.curves) {
    curve.middle = place(curve.middle);
    curve.u = place.rotation * curve.u;
    curve.v = place.rotation * curve.v;
    sample_curve(curve, curve.first, curve.last, box, spacing, keep);
  }
  for (const auto& [a, b, c] : features.faces) sample_face({place(a), place(b), place(c)}, box, face_spacing, keep);
}

void ColliderCrossingFinder::measure_points(const BoundaryPathFinder<3>& finder, const Pose& pose,
                                            std::span<const Sample> samples,
                                            std::vector<ColliderCrossings>& results) const {
  std::vector<Vec3> points;
  for (const Sample& sample : samples) points.push_back(sample.point);
  const LocatedPoints<3> located = finder.locate(points);
  std::vector<PathQuery<3>> queries;
  std::vector<std::size_t> sample_of;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto of_point = std::span(located.queries).subspan(located.first[i], located.first[i + 1] - located.first[i]);
    // A point on the boundary only touches: paths from there would lead to other faces.
    const auto faces = faces_at(*model_, of_point, pose.positions);
    const Body& body = model_->bodies[samples[i].body];
    for (const PathQuery<3>& query : of_point) {
      const VertexTuple<4>& element = model_->mesh.elements()[query.element];
      const bool is_own =
          query.element >= body.first_element && query.element < body.first_element + body.element_count;
      const bool touches = std::ranges::any_of(faces, [&](const auto& face) { return share_a_vertex(face, element); });
      if (!is_own || touches || pose.holds(element)) continue;
      queries.push_back(query);
      sample_of.push_back(i);
    }
  }
  const std::vector<BoundaryPath<3>> paths = finder.find_paths(queries);
  for (std::size_t q = 0; q < queries.size();) {
    const Sample& sample = samples[sample_of[q]];
    double depth = 0;
    bool is_blocked = false;  // then it is inside, nobody knows how deep
    for (const std::size_t i = sample_of[q]; q < queries.size() && sample_of[q] == i; ++q)
      if (paths[q].status == PathStatus::kFound)
        depth = std::max(depth, paths[q].distance);
      else
        is_blocked = true;
    const double cell = cells_[sample.body];
    results[sample.collider].add(
        {0, 0, is_blocked || depth > kMinCrossing * cell, depth, depth / cell, static_cast<Index>(sample.body)});
  }
}

}  // namespace selvage
