// What penetrates, and its ways out.
#include "contact/contact_finder_impl.h"
#include "contact/tangles.h"
#include "core/parallel.h"
#include "core/timed.h"

#include <algorithm>

namespace selvage {

namespace {

bool is_same_point(const Contact& a, const Contact& b) {
  return a.kind == b.kind && a.point_feature == b.point_feature;
}

}  // namespace

std::vector<PenetratingPoint> ContactFinder::Impl::find_boundary_points(std::span<const Vec3> positions) {
  const auto found =
      options.splits() ? search->find(inside, statistics.penetrations) : search->find_all(statistics.penetrations);
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
  if (!off) return {};
  const bool is_any_inside =
      std::any_of(inside_vertices.begin(), inside_vertices.end(), [&](Index v) { return is_of_collider(v); }) ||
      std::any_of(inside_edges.begin(), inside_edges.end(),
                  [&](Index e) { return is_of_collider(surface.edges()[e][0]); });
  std::vector<PenetratingPoint> points;
  if (is_any_inside) points = find_boundary_points(positions_t0);
  std::erase_if(points, [&](const PenetratingPoint& p) { return !is_of_collider(p.vertices[0]) || off->is_let_in(p); });
  return off->choose(positions_t0, points, is_blocked);
}

void ContactFinder::Impl::append_paths(std::span<const Vec3> positions, std::vector<Contact>& contacts) {
  if (options.splits() && inside.empty()) return;
  place(positions);
  std::vector<PenetratingPoint> points;
  timed(statistics.seconds_dcd, [&] {
    points = find_boundary_points(positions);
    if (own_edges_rest) leave_out_own_edges(points);
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

/// Removes the edges of tangles that have a vertex inside.
void ContactFinder::Impl::leave_out_own_edges(std::vector<PenetratingPoint>& points) const {
  std::vector<std::uint8_t> has_vertex(number_tangles(mesh, pieces, points), 0);
  for (const PenetratingPoint& p : points)
    if (p.kind == ContactKind::kVertexPath) has_vertex[p.tangle] = 1;
  std::erase_if(
      points, [&](const PenetratingPoint& p) { return p.kind == ContactKind::kEdgePath && has_vertex[p.tangle] != 0; });
  for (PenetratingPoint& p : points) p.tangle = 0;
}

/// Removes the points of tangles that have a vertex of an inverted element. They need no query for a way out.
std::vector<std::uint8_t> ContactFinder::Impl::leave_out_waiting(std::vector<PenetratingPoint>& points) {
  std::vector<std::uint8_t> waits(1, 0);
  if (inverted.empty()) return waits;
  waits.assign(
      number_tangles(mesh, options.splits() ? std::span<const Index>(pieces) : std::span<const Index>(), points), 0);
  for (const PenetratingPoint& p : points)
    if (inverted.has_any(std::span(p.vertices).first(p.count), p.weights)) waits[p.tangle] = 1;
  statistics.waiting_points += std::erase_if(points, [&](const PenetratingPoint& p) { return waits[p.tangle] != 0; });
  return waits;
}

void ContactFinder::Impl::append_ways_out(std::span<const Vec3> positions, std::vector<PenetratingPoint>& points,
                                          std::vector<Contact>& contacts) {
  if (common) folded_vertices = common->vertices_in_folds(points);
  std::vector<std::uint8_t> waits = leave_out_waiting(points);
  if (euclidean) euclidean->place(positions);
  const std::vector<BoundaryPath<3>> found = find_ways_out(points, positions);
  statistics.path_queries += std::ssize(points);
  // By DCD alone, contacts are all that separates bodies. So a point that is not at an inverted element leaves also by
  // a face that is: while it is inside, it keeps the element inverted.
  for (std::size_t i = 0; i < points.size() && options.splits(); ++i)
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
    if (off && (off->is_let_in(points[i]) || off->waits(points[i]))) {
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

}  // namespace selvage
