#include "contact/ways_out/ways_off_colliders.h"

#include "contact/ways_out/straight_way.h"
#include "core/parallel.h"
#include "core/union_find.h"
#include "mesh/simplex_corners.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace selvage {

namespace {

/// Part of an edge at rest by which a collider stands deep in a piece. What is less deep comes out by contacts alone.
constexpr double kDeep = 0.25;
/// Times its length by which a way leads past what it has to, not just up to it.
constexpr double kBeyond = 1.001;
/// Part of its rest volume below which an element is pressed.
constexpr double kPressed = 0.3;

/// Those of some points that are inside, once for each element.
std::vector<PenetratingPoint> inside_of(const PointLocator<3>& locator, std::span<const ColliderPoint> on_faces) {
  std::vector<PenetratingPoint> points;
  std::vector<Vec3> positions;
  for (const ColliderPoint& point : on_faces) positions.push_back(point.position);
  const LocatedPoints<3> located = locator.locate(positions);
  for (std::size_t i = 0; i < on_faces.size(); ++i)
    for (std::int64_t q = located.first[i]; q < located.first[i + 1]; ++q) {
      PenetratingPoint& point = points.emplace_back();
      point.vertices[0] = on_faces[i].vertex;
      point.query = located.queries[q];
    }
  return points;
}

/// Six times the volume of an element.
double volume_of(const VertexTuple<4>& element, std::span<const Vec3> positions) {
  const auto [a, b, c, d] = corners_of(element, positions);
  return (b - a).cross(c - a).dot(d - a);
}

}  // namespace

WaysOffColliders::WaysOffColliders(const TetMesh& mesh, std::span<const Vec3> rest_positions,
                                   const TriangleMesh& surface, Index body_faces)
    : mesh_(mesh), rest_positions_(rest_positions.begin(), rest_positions.end()), pieces_(mesh.element_components()) {
  UnionFind parts(surface.vertex_count());
  for (const auto& [a, b, c] : surface.triangles().subspan(body_faces)) {
    parts.join(a, b);
    parts.join(a, c);
  }
  for (Index v = 0; v < surface.vertex_count(); ++v) colliders_.push_back(parts.lowest(v));
}

const WaysOffColliders::Chosen* WaysOffColliders::chosen_for(const PenetratingPoint& point) const {
  if (point.vertices[0] < mesh_.vertex_count()) return nullptr;
  const Index piece = pieces_[point.query.element];
  const auto at = std::find_if(chosen_.begin(), chosen_.end(), [&](const Chosen& c) { return c.piece == piece; });
  return at == chosen_.end() ? nullptr : &*at;
}

bool WaysOffColliders::waits(const PenetratingPoint& point) const {
  if (chosen_for(point) == nullptr) return false;
  for (const Index v : mesh_.elements()[point.query.element])
    for (const Index e : mesh_.vertex_elements(v)) {
      const auto& corners = mesh_.elements()[e];
      if (volume_of(corners, start_positions_) < kPressed * volume_of(corners, rest_positions_)) return true;
    }
  return false;
}

bool WaysOffColliders::lets_in(Index of_mesh, Index of_collider) const {
  const auto elements = mesh_.vertex_elements(of_mesh);
  if (empty() || elements.empty()) return false;
  const Index piece = pieces_[elements[0]];
  return std::any_of(chosen_.begin(), chosen_.end(), [&](const Chosen& chosen) {
    return chosen.piece == piece &&
           std::binary_search(chosen.parts.begin(), chosen.parts.end(), colliders_[of_collider]);
  });
}

void WaysOffColliders::apply(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                             std::span<BoundaryPath<3>> paths) const {
  for (std::size_t i = 0; i < points.size() && !empty(); ++i) {
    const Chosen* chosen = chosen_for(points[i]);
    if (chosen == nullptr) continue;
    const PathQuery<3>& query = points[i].query;
    const BoundaryPath<3> way = straight_way(mesh_, positions, query.point, query.element, -chosen->direction);
    if (way.status == PathStatus::kFound) paths[i] = way;
  }
}

/// The shortest at rest.
double WaysOffColliders::edge_at(Index element) const {
  double shortest = HUGE_VAL;
  const auto& corners = mesh_.elements()[element];
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < i; ++k)
      shortest = std::min(shortest, (rest_positions_[corners[i]] - rest_positions_[corners[k]]).norm());
  return shortest;
}

/// Where points leave the piece in a direction: a place and the outward normal of the face there.
std::vector<BoundaryPath<3>> WaysOffColliders::straight_ways(std::span<const Vec3> positions,
                                                             std::span<const PenetratingPoint> points,
                                                             const Vec3& direction) const {
  std::vector<BoundaryPath<3>> ways;
  for (const PenetratingPoint& point : points) {
    BoundaryPath<3> way = straight_way(mesh_, positions, point.query.point, point.query.element, direction);
    if (way.status != PathStatus::kFound) continue;
    way.normal = area_normal(corners_of(mesh_.boundary_faces()[way.face], positions)).normalized();
    if (way.normal.dot(direction) > 0) ways.push_back(way);
  }
  return ways;
}

/// Parts of colliders that points are of, ascending.
std::vector<Index> WaysOffColliders::parts_of(std::span<const PenetratingPoint> points) const {
  std::vector<Index> parts;
  for (const PenetratingPoint& point : points) parts.push_back(colliders_[point.vertices[0]]);
  std::sort(parts.begin(), parts.end());
  parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
  return parts;
}

/// Points of the parts of colliders that some points are of, no farther from the piece than it is large.
std::vector<Vec3> WaysOffColliders::beside(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                           std::span<const ColliderPoint> on_faces) const {
  const std::vector<Index> parts = parts_of(points);
  Eigen::AlignedBox3d box;
  for (Index e = 0; e < mesh_.element_count(); ++e)
    if (pieces_[e] == pieces_[points[0].query.element])
      for (const Index v : mesh_.elements()[e]) box.extend(positions[v]);
  const Vec3 size = Vec3::Constant(box.sizes().maxCoeff());
  box = Eigen::AlignedBox3d(box.min() - size, box.max() + size);
  std::vector<Vec3> near;
  const auto keep = [&](const Vec3& position, Index vertex) {
    if (box.contains(position) && std::binary_search(parts.begin(), parts.end(), colliders_[vertex]))
      near.push_back(position);
  };
  for (Index v = mesh_.vertex_count(); v < std::ssize(positions); ++v) keep(positions[v], v);
  for (const ColliderPoint& point : on_faces) keep(point.position, point.vertex);
  return near;
}

/// Of the piece that all points are in; empty where it is not deep.
WaysOffColliders::Ways WaysOffColliders::ways_of(std::span<const Vec3> positions,
                                                 std::span<const PenetratingPoint> points,
                                                 std::span<const ColliderPoint> on_faces) const {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const PenetratingPoint& point : points) mean += point.query.point / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double edge = HUGE_VAL;
  for (const PenetratingPoint& point : points) {
    const Eigen::Vector3d offset = point.query.point - mean;
    spread += offset * offset.transpose();
    edge = std::min(edge, edge_at(point.query.element));
  }
  std::vector<WayOff> ways;
  std::vector<std::vector<BoundaryPath<3>>> exits;
  for (const Vec3& direction : directions_to_try(spread)) {
    exits.push_back(straight_ways(positions, points, direction));
    ways.push_back({-direction, 0, 0});
    for (const BoundaryPath<3>& exit : exits.back()) ways.back().way = std::max(ways.back().way, exit.distance);
    if (!(ways.back().way > kDeep * edge)) return {};
  }
  const std::vector<Vec3> near = beside(positions, points, on_faces);
  for (std::size_t d = 0; d < ways.size(); ++d) {
    ways[d].length = ways[d].way;
    for (const Vec3& p : near) {
      double least = HUGE_VAL;
      for (const BoundaryPath<3>& exit : exits[d])
        least = std::min(least, exit.normal.dot(exit.point - p) / -exit.normal.dot(ways[d].direction));
      ways[d].length = std::max(ways[d].length, least);
    }
  }
  std::stable_sort(ways.begin(), ways.end(), [](const WayOff& a, const WayOff& b) { return a.length < b.length; });
  return {ways, near};
}

/// Whether a point of a collider is inside the piece when that has moved.
bool WaysOffColliders::ends_inside(const PointLocator<3>& locator, std::span<const Vec3> near, Index piece,
                                   const WayOff& off) const {
  std::vector<Vec3> ends;
  for (const Vec3& p : near) ends.push_back(p - kBeyond * off.length * off.direction);
  const LocatedPoints<3> located = locator.locate(ends);
  return std::any_of(located.queries.begin(), located.queries.end(),
                     [&](const PathQuery<3>& query) { return pieces_[query.element] == piece; });
}

std::vector<PieceWayOff> WaysOffColliders::choose(std::span<const Vec3> positions, const PointLocator<3>& locator,
                                                  std::span<const PenetratingPoint> on_surfaces,
                                                  std::span<const ColliderPoint> on_faces,
                                                  const std::function<bool(Index, const Vec3&)>& is_blocked) {
  struct Pierced {
    Index piece;
    std::vector<PenetratingPoint> points, on_faces;
    bool is_through;
    Ways found;
  };
  std::map<Index, Pierced> of_pieces;
  const auto pierced_at = [&](const PenetratingPoint& p) -> Pierced& { return of_pieces[pieces_[p.query.element]]; };
  for (const PenetratingPoint& p : on_surfaces) pierced_at(p).points.push_back(p);
  for (const PenetratingPoint& p : inside_of(locator, on_faces)) pierced_at(p).on_faces.push_back(p);
  std::vector<Pierced> all;
  for (auto& [piece, pierced] : of_pieces) {
    pierced.piece = piece;
    all.push_back(std::move(pierced));
  }
  parallel_for(std::ssize(all), 1, [&](std::int64_t i) {
    auto& [piece, points, own_faces, is_through, found] = all[i];
    is_through = own_faces.size() > points.size();
    if (is_through) points.insert(points.end(), own_faces.begin(), own_faces.end());
    found = ways_of(positions, points, is_through ? on_faces : std::span<const ColliderPoint>());
  });
  std::vector<PieceWayOff> chosen;
  for (const auto& [piece, points, own_faces, is_through, found] : all) {
    const Index vertex = mesh_.elements()[points[0].query.element][0];
    const WayOff* best = nullptr;
    for (const WayOff& off : found.ways) {
      if (is_blocked(vertex, off.length * off.direction)) continue;
      const bool is_off = !is_through || !ends_inside(locator, found.near, piece, off);
      if (best == nullptr || is_off) best = &off;
      if (is_off) break;
    }
    if (best == nullptr) continue;
    chosen.push_back({vertex, best->direction, best->way, is_through});
    chosen_.push_back({piece, best->direction, is_through ? parts_of(points) : std::vector<Index>()});
  }
  if (!empty()) start_positions_.assign(positions.begin(), positions.end());
  return chosen;
}

}  // namespace selvage
