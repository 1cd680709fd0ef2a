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
/// Part of its rest volume below which an element is pressed.
constexpr double kPressed = 0.3;

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

void WaysOffColliders::let_in(Index of_mesh, std::span<const Index> of_colliders) {
  const auto elements = mesh_.vertex_elements(of_mesh);
  if (elements.empty()) return;
  for (const Index v : of_colliders) let_in_.push_back({pieces_[elements[0]], colliders_[v]});
  std::sort(let_in_.begin(), let_in_.end());
  let_in_.erase(std::unique(let_in_.begin(), let_in_.end()), let_in_.end());
}

bool WaysOffColliders::is_let_in(const PenetratingPoint& point) const {
  if (let_in_.empty() || point.vertices[0] < mesh_.vertex_count()) return false;
  return std::binary_search(let_in_.begin(), let_in_.end(),
                            std::array{pieces_[point.query.element], colliders_[point.vertices[0]]});
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
  return std::binary_search(let_in_.begin(), let_in_.end(), std::array{pieces_[elements[0]], colliders_[of_collider]});
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

/// Points of the parts of colliders that some points are of, no farther from the piece than it is large.
std::vector<Vec3> WaysOffColliders::beside(std::span<const Vec3> positions,
                                           std::span<const PenetratingPoint> points) const {
  std::vector<Index> parts;
  for (const PenetratingPoint& point : points) parts.push_back(colliders_[point.vertices[0]]);
  std::sort(parts.begin(), parts.end());
  Eigen::AlignedBox3d box;
  for (Index e = 0; e < mesh_.element_count(); ++e)
    if (pieces_[e] == pieces_[points[0].query.element])
      for (const Index v : mesh_.elements()[e]) box.extend(positions[v]);
  const Vec3 size = Vec3::Constant(box.sizes().maxCoeff());
  box = Eigen::AlignedBox3d(box.min() - size, box.max() + size);
  std::vector<Vec3> near;
  for (Index v = mesh_.vertex_count(); v < std::ssize(positions); ++v)
    if (box.contains(positions[v]) && std::binary_search(parts.begin(), parts.end(), colliders_[v]))
      near.push_back(positions[v]);
  return near;
}

/// Of the piece that all points are in, the shortest first; empty where it is not deep.
std::vector<WayOff> WaysOffColliders::ways_of(std::span<const Vec3> positions,
                                              std::span<const PenetratingPoint> points) const {
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
  const std::vector<Vec3> near = beside(positions, points);
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
  return ways;
}

std::vector<PieceWayOff> WaysOffColliders::choose(std::span<const Vec3> positions,
                                                  std::span<const PenetratingPoint> points,
                                                  const std::function<bool(Index, const Vec3&)>& is_blocked) {
  std::map<Index, std::vector<PenetratingPoint>> of_pieces;
  for (const PenetratingPoint& p : points) of_pieces[pieces_[p.query.element]].push_back(p);
  std::vector<std::pair<Index, std::vector<PenetratingPoint>>> all(of_pieces.begin(), of_pieces.end());
  std::vector<std::vector<WayOff>> found(all.size());
  parallel_for(std::ssize(all), 1, [&](std::int64_t i) { found[i] = ways_of(positions, all[i].second); });
  std::vector<PieceWayOff> chosen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto& [piece, inside] = all[i];
    const Index vertex = mesh_.elements()[inside[0].query.element][0];
    const auto best = std::find_if(found[i].begin(), found[i].end(),
                                   [&](const WayOff& off) { return !is_blocked(vertex, off.length * off.direction); });
    if (best == found[i].end()) continue;
    chosen.push_back({vertex, best->direction, best->way});
    chosen_.push_back({piece, best->direction});
  }
  if (!empty()) start_positions_.assign(positions.begin(), positions.end());
  return chosen;
}

}  // namespace selvage
