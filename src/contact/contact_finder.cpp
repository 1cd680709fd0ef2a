#include "selvage/contact/contact_finder.h"

#include "contact/closest_rules.h"
#include "contact/contours/cloth_contours.h"
#include "contact/impacts/impact_search.h"
#include "contact/impacts/met_faces.h"
#include "contact/impacts/near_contacts.h"
#include "contact/input/collider_triangles.h"
#include "contact/input/inverted_vertices.h"
#include "contact/penetration_search.h"
#include "contact/tangled_vertices.h"
#include "contact/tangles.h"
#include "contact/ways_out/common_ways_out.h"
#include "contact/ways_out/path_contact.h"
#include "contact/ways_out/ways_off_colliders.h"
#include "core/parallel.h"
#include "core/timed.h"
#include "mesh/position_extent.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace selvage {

namespace {

bool is_same_point(const Contact& a, const Contact& b) {
  return a.kind == b.kind && a.point_feature == b.point_feature;
}

}  // namespace

struct ContactFinder::Impl {
  const TetMesh& mesh;
  ContactOptions options;
  TriangleMesh surface;
  Index body_faces;  ///< of the boundary and of cloth
  std::vector<Vec3> positions_t0;
  std::optional<PenetrationSearch> search;
  ImpactSearch impacts;
  MetFaces met_faces;              ///< by the last search of impacts
  std::optional<NearSearch> near;  ///< of thick cloth
  std::optional<RestPoseRule> rest_pose;
  std::optional<EuclideanRule> euclidean;
  Contours contours;                    ///< of cloth at the start of the step; none but for kHybrid
  std::optional<CommonWaysOut> common;  ///< of the shortest paths, where bodies penetrate at the start of steps only
  std::optional<WaysOffColliders> off;  ///< likewise, where there are colliders and rest positions

  std::vector<Index> inside;  ///< features of the search that penetrate at the start of the step
  std::vector<std::uint8_t> is_inside;
  std::vector<Index> inside_vertices, inside_edges;
  TangledVertices tangled;    ///< at the start of the step; none but for kHybrid
  InvertedVertices inverted;  ///< at the start of the step
  std::vector<Index> pieces;  ///< connected component of each element; where whole tangles wait
  ContactStatistics statistics;
  bool has_begun = false;  ///< any step

  Impl(const TetMesh& m, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
       std::span<const Index> vertex_objects, ContactOptions o, std::span<const VertexTuple<3>> colliders,
       ContactCloth cloth);

  /// With the colliders'.
  Index vertex_count() const { return surface.vertex_count(); }
  std::span<const Vec3> of_mesh(std::span<const Vec3> positions) const { return positions.first(mesh.vertex_count()); }
  SurfaceStep step_to(std::span<const Vec3> positions) const {
    return {surface, positions_t0, positions, mesh.boundary_face_count(), body_faces};
  }
  bool is_of_collider(Index vertex) const { return vertex >= mesh.vertex_count(); }

  bool uses_ccd() const {
    return !options.interior_points && (options.mode == DetectionMode::kCcd || options.mode == DetectionMode::kHybrid);
  }
  bool splits() const { return !options.interior_points && options.mode == DetectionMode::kHybrid; }
  bool uses_dcd() const {
    return options.mode != DetectionMode::kOff && (options.interior_points || options.mode != DetectionMode::kCcd);
  }

  void begin_step(std::span<const Vec3> positions);
  void split_features();
  void find_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts);
  std::vector<PenetratingPoint> find_boundary_points(std::span<const Vec3> positions);
  void append_interior_points(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points) const;
  void place(std::span<const Vec3> positions);
  std::vector<BoundaryPath<3>> find_ways_out(std::span<const PenetratingPoint> points, std::span<const Vec3> positions);
  std::vector<PieceWayOff> choose_ways_off(const std::function<bool(Index, const Vec3&)>& is_blocked);
  void append_paths(std::span<const Vec3> positions, std::vector<Contact>& contacts);
  std::vector<std::uint8_t> leave_out_waiting(std::vector<PenetratingPoint>& points);
  void append_ways_out(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points,
                       std::vector<Contact>& contacts);
  ContinuousPairs find_pairs(std::span<const Vec3> positions);
  StepImpacts find_impacts(std::span<const Vec3> positions);
  StepImpacts find_untangled_impacts(std::span<const Vec3> positions);
  void append_contacts(const StepImpacts& found, std::span<const Vec3> positions, std::vector<Contact>& contacts) const;
  void append_near(std::vector<Contact>& contacts);
};

ContactFinder::Impl::Impl(const TetMesh& m, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                          std::span<const Index> vertex_objects, ContactOptions o,
                          std::span<const VertexTuple<3>> colliders, ContactCloth cloth)
    : mesh(m),
      options(o),
      surface(surface_with_colliders(m, colliders, positions.size(), cloth.triangles)),
      body_faces(m.boundary_face_count() + static_cast<Index>(cloth.triangles.size())),
      impacts(surface, body_faces),
      met_faces(surface, body_faces),
      tangled(surface, m.boundary_face_count(), body_faces, o.guarantee) {
  check_positions<3>(positions, vertex_count());
  if (!vertex_objects.empty() && std::ssize(vertex_objects) != mesh.vertex_count())
    throw Error("vertex_objects", fmt::format("{} for {} vertices", vertex_objects.size(), mesh.vertex_count()),
                "give one per vertex, or none at all");
  const bool uses_rest = options.rule == ClosestPointRule::kRestPose;
  if (uses_rest || !rest_positions.empty()) check_positions<3>(rest_positions, mesh.vertex_count(), "rest_positions");
  if (uses_rest) rest_pose.emplace(mesh, rest_positions);
  if (options.rule == ClosestPointRule::kEuclidean) euclidean.emplace(mesh, vertex_objects);
  if (uses_dcd())
    search.emplace(mesh, surface, body_faces, options.detect_edges, positions,
                   PathOptions{options.cull_infeasible_regions, true}, !options.interior_points);
  positions_t0.assign(positions.begin(), positions.end());
  if (search) is_inside.resize(search->feature_count());
  if (splits() && options.rule == ClosestPointRule::kShortestPath) {
    common.emplace(mesh);
    if (!colliders.empty() && !rest_positions.empty()) off.emplace(mesh, rest_positions, surface, body_faces);
  }
  if (splits() && options.wait_for_inverted) pieces = mesh.element_components();
  if (std::any_of(cloth.thickness.begin(), cloth.thickness.end(), [](double t) { return t > 0; }) && uses_ccd()) {
    check_positions<3>(rest_positions, mesh.vertex_count(), "rest_positions");
    std::vector<double> thickness(cloth.thickness.begin(), cloth.thickness.end());
    thickness.resize(vertex_count(), 0.0);
    near.emplace(step_to(positions_t0), separated_at_rest(rest_positions, vertex_objects, vertex_count()),
                 std::move(thickness));
  }
}

void ContactFinder::Impl::begin_step(std::span<const Vec3> positions) {
  check_positions<3>(positions, vertex_count());
  statistics = {};
  has_begun = true;
  if (off) off->begin_step();
  positions_t0.assign(positions.begin(), positions.end());
  impacts.begin_step();
  if (splits()) split_features();
  if (!options.wait_for_inverted) return;
  inverted = splits() ? InvertedVertices(mesh, of_mesh(positions_t0), search->locator().defective_elements())
                      : InvertedVertices(mesh, of_mesh(positions_t0));
}

void ContactFinder::Impl::split_features() {
  place(positions_t0);
  timed(statistics.seconds_split, [&] {
    for (const Index f : inside) is_inside[f] = 0;
    inside.clear();
    inside_vertices.clear();
    inside_edges.clear();
    const auto candidates = met_faces.take_candidates(positions_t0, search->crossings());
    for (const Penetration& p : search->find_all(statistics.penetrations, candidates)) {
      if (is_inside[p.feature]) continue;
      is_inside[p.feature] = 1;
      inside.push_back(p.feature);
      if (search->is_edge(p.feature)) {
        inside_edges.push_back(search->edge_of(p.feature));
      } else {
        inside_vertices.push_back(search->vertex_of(p.feature));
      }
    }
  });
  tangled.mark(inside_vertices, inside_edges, search->crossings());
  contours = {};
  if (body_faces > mesh.boundary_face_count())
    contours = find_contours(surface, positions_t0, search->crossings(), mesh.boundary_face_count(), body_faces);
  statistics.unguarded_vertices = tangled.count();
  statistics.penetrating_vertices = std::ssize(inside_vertices);
  statistics.penetrating_edges = std::ssize(inside_edges);
}

std::vector<PenetratingPoint> ContactFinder::Impl::find_boundary_points(std::span<const Vec3> positions) {
  const auto found =
      splits() ? search->find(inside, statistics.penetrations) : search->find_all(statistics.penetrations);
  std::vector<PenetratingPoint> points;
  for (const Penetration& p : found) {
    if (search->is_edge(p.feature)) {
      const Index edge = search->edge_of(p.feature);
      points.push_back(penetrating_edge(edge, surface.edges()[edge], p.middle, p.element, positions));
    } else {
      points.push_back(penetrating_vertex(search->vertex_of(p.feature), p.element, positions));
    }
    PenetratingPoint& point = points.back();
    if (is_of_collider(point.vertices[0])) point.query = PathQuery<3>::at(point.query.point, p.element);
  }
  return points;
}

/// Inner vertices and centroids, each with all elements that hold it and share no vertex with it.
void ContactFinder::Impl::append_interior_points(std::span<const Vec3> positions,
                                                 std::vector<PenetratingPoint>& points) const {
  const PenetrationSearch::Interior interior = search->find_interior();
  for (const auto& [vertex, element] : interior.vertices)
    points.push_back(penetrating_vertex(vertex, element, positions));
  for (const auto& [of_element, element] : interior.centroids)
    points.push_back(penetrating_centroid(of_element, mesh.elements()[of_element], element, positions));
}

void ContactFinder::Impl::place(std::span<const Vec3> positions) {
  timed(statistics.seconds_refit, [&] { search->place(positions); });
  ++statistics.pose_updates;
}

std::vector<BoundaryPath<3>> ContactFinder::Impl::find_ways_out(std::span<const PenetratingPoint> points,
                                                                std::span<const Vec3> positions) {
  std::vector<PathQuery<3>> queries;
  for (const PenetratingPoint& point : points) queries.push_back(point.query);
  if (rest_pose) return rest_pose->find(queries, of_mesh(positions));
  std::vector<PathCounters> counters(queries.size());
  std::vector<BoundaryPath<3>> found = search->paths().find_paths(queries, {}, counters);
  for (const PathCounters& counter : counters) statistics.paths += counter;
  if (euclidean)
    parallel_for(std::ssize(points), 64, [&](std::int64_t i) {
      if (euclidean->applies_to(points[i])) found[i] = euclidean->find(points[i].query, positions);
    });
  if (common) common->apply(positions, points, found);
  if (off) off->apply(positions, points, found);
  return found;
}

std::vector<PieceWayOff> ContactFinder::Impl::choose_ways_off(
    const std::function<bool(Index, const Vec3&)>& is_blocked) {
  const bool is_any_inside =
      std::any_of(inside_vertices.begin(), inside_vertices.end(), [&](Index v) { return is_of_collider(v); }) ||
      std::any_of(inside_edges.begin(), inside_edges.end(),
                  [&](Index e) { return is_of_collider(surface.edges()[e][0]); });
  if (!off || !is_any_inside) return {};
  std::vector<PenetratingPoint> points = find_boundary_points(positions_t0);
  std::erase_if(points, [&](const PenetratingPoint& p) { return !is_of_collider(p.vertices[0]); });
  return off->choose(positions_t0, points, is_blocked);
}

void ContactFinder::Impl::append_paths(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  if (splits() && inside.empty()) return;
  place(positions);
  std::vector<PenetratingPoint> points;
  timed(statistics.seconds_dcd, [&] {
    points = find_boundary_points(positions);
    if (options.interior_points) append_interior_points(positions, points);
  });
  if (points.empty()) return;
  timed(statistics.seconds_refit, [&] { search->prepare_paths(); });
  // Inner vertices are listed after boundary ones, and edges between: each kind in one run, by its numbers.
  std::stable_sort(points.begin(), points.end(), [](const PenetratingPoint& a, const PenetratingPoint& b) {
    return std::pair(a.kind, a.feature) < std::pair(b.kind, b.feature);
  });
  timed(statistics.seconds_paths, [&] { append_ways_out(positions, points, contacts); });
}

/// Removes the points of tangles that have a vertex of an inverted element. They need no query for a way out.
std::vector<std::uint8_t> ContactFinder::Impl::leave_out_waiting(std::vector<PenetratingPoint>& points) {
  std::vector<std::uint8_t> waits(1, 0);
  if (inverted.empty()) return waits;
  waits.assign(number_tangles(mesh, pieces, points), 0);
  for (const PenetratingPoint& p : points)
    if (inverted.has_any(std::span(p.vertices).first(p.count), p.weights)) waits[p.tangle] = 1;
  statistics.waiting_points += std::erase_if(points, [&](const PenetratingPoint& p) { return waits[p.tangle] != 0; });
  return waits;
}

void ContactFinder::Impl::append_ways_out(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points,
                                          std::vector<Contact>& contacts) {
  std::vector<std::uint8_t> waits = leave_out_waiting(points);
  if (euclidean) euclidean->place(positions);
  const std::vector<BoundaryPath<3>> found = find_ways_out(points, positions);
  statistics.path_queries += std::ssize(points);
  // By DCD alone, contacts are all that separates bodies. So a point that is not at an inverted element leaves also by
  // a face that is: while it is inside, it keeps the element inverted.
  for (std::size_t i = 0; i < points.size() && splits(); ++i)
    if (found[i].status == PathStatus::kFound &&
        inverted.has_any(mesh.boundary_faces()[found[i].face], found[i].barycentric))
      waits[points[i].tangle] = 1;
  std::size_t first = contacts.size();  // of those of the same point
  for (std::size_t i = 0; i < points.size(); ++i) {
    statistics.waiting_points += waits[points[i].tangle];
    if (waits[points[i].tangle] != 0) continue;
    if (found[i].status != PathStatus::kFound) {
      ++statistics.blocked_paths;
      continue;
    }
    if (off && off->waits(points[i])) {
      ++statistics.waiting_points;
      continue;
    }
    const Contact contact = is_of_collider(points[i].vertices[0])
                                ? collider_path_contact(mesh, positions, points[i], found[i])
                                : path_contact(mesh, points[i], found[i]);
    // A point between two elements is in both, and leaves them the same way.
    const auto same = [&](const Contact& other) {
      return other.surface_feature == contact.surface_feature && other.point == contact.point;
    };
    if (first < contacts.size() && !is_same_point(contacts[first], contact)) first = contacts.size();
    // A way out that ends on a face of the point's own vertices can move none of them.
    const bool moves = contact.count > 0 && !contact.normal.isZero(0);
    if (!moves || std::any_of(contacts.begin() + first, contacts.end(), same)) continue;
    contacts.push_back(contact);
  }
}

/// All that meet on the way.
ContinuousPairs ContactFinder::Impl::find_pairs(std::span<const Vec3> positions) {
  ContinuousPairs pairs = impacts.find_pairs(positions_t0, positions, statistics.continuous);
  if (splits()) met_faces.note(positions, pairs);
  if (!options.detect_edges) pairs.edge_edge.clear();
  return pairs;
}

/// Those that are to be contacts.
StepImpacts ContactFinder::Impl::find_impacts(std::span<const Vec3> positions) {
  ContinuousPairs pairs = find_pairs(positions);
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) { return p.face >= body_faces; });
  if (splits()) {
    const auto inside_of = [](std::span<const Index> all, Index i) {
      return std::binary_search(all.begin(), all.end(), i);
    };
    std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) { return inside_of(inside_vertices, p.vertex); });
    std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
      return inside_of(inside_edges, p.first) || inside_of(inside_edges, p.second);
    });
  }
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
    return tangled.is_of_cloth({&p.vertex, 1}, surface.triangles()[p.face]);
  });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return tangled.is_of_cloth(surface.edges()[p.first], surface.edges()[p.second]);
  });
  return impacts.with_times(std::move(pairs));
}

/// Those that are to be held back: at no vertex where bodies penetrate; of two features of cloth, not where both have
/// one. Without the guarantee of no inverted element
/// either, and no vertices of the mesh that run into colliders, which are kept out by the shapes.
StepImpacts ContactFinder::Impl::find_untangled_impacts(std::span<const Vec3> positions) {
  ContinuousPairs pairs = find_pairs(positions);
  const auto is_left_out = [&](std::span<const Index> one, std::span<const Index> other) {
    return tangled.leaves_out(one, other) || (!options.guarantee && (inverted.has_any(one) || inverted.has_any(other)));
  };
  std::erase_if(pairs.vertex_face, [&](const VertexFacePair& p) {
    return (!options.guarantee && p.face >= body_faces) || is_left_out({&p.vertex, 1}, surface.triangles()[p.face]);
  });
  std::erase_if(pairs.edge_edge, [&](const EdgeEdgePair& p) {
    return is_left_out(surface.edges()[p.first], surface.edges()[p.second]);
  });
  return impacts.with_times(std::move(pairs));
}

void ContactFinder::Impl::append_contacts(const StepImpacts& found, std::span<const Vec3> positions,
                                          std::vector<Contact>& contacts) const {
  const std::size_t first = contacts.size();
  append_impact_contacts(step_to(positions), found, contacts);
  const auto waits = [&](const Contact& c) {
    return inverted.has_any(std::span(c.vertices).first(c.count), c.weights);
  };
  contacts.erase(std::remove_if(contacts.begin() + first, contacts.end(), waits), contacts.end());
}

/// But for what is tangled: the normal may point the wrong way there.
void ContactFinder::Impl::append_near(std::vector<Contact>& contacts) {
  const std::size_t first = contacts.size();
  near->append_contacts(positions_t0, contacts);
  const auto is_tangled = [&](const Contact& c) { return tangled.has_any(std::span(c.vertices).first(c.count)); };
  contacts.erase(std::remove_if(contacts.begin() + first, contacts.end(), is_tangled), contacts.end());
}

void ContactFinder::Impl::find_contacts(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  if (!has_begun) throw Error("step", "has not begun", "call begin_step() first");
  check_positions<3>(positions, vertex_count());
  contacts.clear();
  if (uses_dcd()) append_paths(positions, contacts);
  if (uses_ccd()) timed(statistics.seconds_ccd, [&] { append_contacts(find_impacts(positions), positions, contacts); });
  if (near) timed(statistics.seconds_ccd, [&] { append_near(contacts); });
  append_contour_contacts(surface, positions_t0, contours, contacts);
  for (const Contact& contact : contacts) ++statistics.contacts[static_cast<int>(contact.kind)];
}

ContactFinder::ContactFinder(const TetMesh& mesh, std::span<const Vec3> rest_positions, std::span<const Vec3> positions,
                             std::span<const Index> vertex_objects, ContactOptions options,
                             std::span<const VertexTuple<3>> colliders, ContactCloth cloth)
    : impl_(std::make_unique<Impl>(mesh, rest_positions, positions, vertex_objects, options, colliders, cloth)) {}
ContactFinder::~ContactFinder() = default;
ContactFinder::ContactFinder(ContactFinder&&) noexcept = default;
ContactFinder& ContactFinder::operator=(ContactFinder&&) noexcept = default;

void ContactFinder::begin_step(std::span<const Vec3> positions_t0) {
  impl_->begin_step(positions_t0);
}

std::vector<PieceWayOff> ContactFinder::choose_ways_off(const std::function<bool(Index, const Vec3&)>& is_blocked) {
  if (!impl_->has_begun) throw Error("step", "has not begun", "call begin_step() first");
  return impl_->choose_ways_off(is_blocked);
}

void ContactFinder::find_contacts(std::span<const Vec3> positions_t1, std::vector<Contact>& contacts) {
  impl_->find_contacts(positions_t1, contacts);
}

StepImpacts ContactFinder::find_impacts(std::span<const Vec3> positions_t1) {
  if (!impl_->has_begun) throw Error("step", "has not begun", "call begin_step() first");
  check_positions<3>(positions_t1, impl_->vertex_count());
  StepImpacts found;
  if (impl_->uses_ccd())
    timed(impl_->statistics.seconds_ccd, [&] { found = impl_->find_untangled_impacts(positions_t1); });
  return found;
}

void ContactFinder::append_contacts(const StepImpacts& impacts, std::span<const Vec3> positions_t1,
                                    std::vector<Contact>& contacts) {
  const std::size_t first = contacts.size();
  impl_->append_contacts(impacts, positions_t1, contacts);
  for (std::size_t i = first; i < contacts.size(); ++i)
    ++impl_->statistics.contacts[static_cast<int>(contacts[i].kind)];
}

const ContactStatistics& ContactFinder::statistics() const {
  return impl_->statistics;
}

const TriangleMesh& ContactFinder::surface() const {
  return impl_->surface;
}

std::span<const Index> ContactFinder::penetrating_vertices() const {
  return impl_->inside_vertices;
}

std::span<const Index> ContactFinder::penetrating_edges() const {
  return impl_->inside_edges;
}

}  // namespace selvage
