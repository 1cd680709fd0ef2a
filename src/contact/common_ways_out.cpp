#include "contact/common_ways_out.h"

#include "core/parallel.h"
#include "core/union_find.h"
#include "mesh/simplex_corners.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Length of the sum of all ways out over the sum of their lengths, below which they disagree.
constexpr double kAgreement = 0.5;
/// Points of a tangle by which directions are compared.
constexpr std::size_t kSamples = 64;
/// Sine of the angle to a face below which a straight way does not leave by it.
constexpr double kParallel = 1e-9;
/// Elements on a straight way, at most.
constexpr int kMaxElements = 1000;

/// Towards the faces, edges and corners of a cube.
std::vector<Vec3> directions_all_around() {
  std::vector<Vec3> directions;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0) directions.push_back(Vec3(x, y, z).normalized());
  return directions;
}

}  // namespace

CommonWaysOut::CommonWaysOut(const TetMesh& mesh) : mesh_(mesh), pieces_(mesh.element_components()) {}

/// By tangles; each tangle by points.
std::vector<CommonWaysOut::Member> CommonWaysOut::members_of(std::span<const PenetratingPoint> points) const {
  struct Place {
    std::array<Index, 2> pieces;
    Index vertex, member;
    auto operator<=>(const Place&) const = default;
  };
  std::vector<Member> members;
  std::vector<Place> places;
  std::vector<Index> in_own_piece;
  for (Index i = 0; i < std::ssize(points); ++i) {
    const PenetratingPoint& point = points[i];
    const bool is_collider = is_of_collider(point);
    if (!is_collider && mesh_.vertex_elements(point.vertices[0]).empty()) continue;  // of cloth
    const Index own = is_collider ? kNone : pieces_[mesh_.vertex_elements(point.vertices[0]).front()],
                other = pieces_[point.query.element];
    if (own == other) {
      in_own_piece.push_back(i);
      continue;
    }
    const std::array<Index, 2> pieces{std::min(own, other), std::max(own, other)};
    const auto member = static_cast<Index>(members.size());
    members.push_back({kNone, i, own < other ? 1.0 : -1.0});
    for (int k = 0; k < point.count; ++k) places.push_back({pieces, point.vertices[k], member});
    for (const Index v : mesh_.elements()[point.query.element]) places.push_back({pieces, v, member});
  }
  std::sort(places.begin(), places.end());
  UnionFind tangles(members.size());
  for (std::size_t k = 1; k < places.size(); ++k)
    if (places[k].pieces == places[k - 1].pieces && places[k].vertex == places[k - 1].vertex)
      tangles.join(places[k - 1].member, places[k].member);
  for (Index m = 0; m < std::ssize(members); ++m) members[m].tangle = tangles.lowest(m);
  append_members_in_own_piece(points, in_own_piece, members);
  std::stable_sort(members.begin(), members.end(),
                   [](const Member& a, const Member& b) { return a.tangle < b.tangle; });
  return members;
}

/// A part that runs through another part of its own piece: the vertices of a point are on one side, those of the
/// element that it is in on the other. Where that contradicts itself, as in a fold, there are no two sides, and no
/// members.
void CommonWaysOut::append_members_in_own_piece(std::span<const PenetratingPoint> points,
                                                std::span<const Index> in_own_piece,
                                                std::vector<Member>& members) const {
  std::vector<Index> vertices;
  for (const Index i : in_own_piece) {
    vertices.insert(vertices.end(), points[i].vertices.begin(), points[i].vertices.begin() + points[i].count);
    const auto& element = mesh_.elements()[points[i].query.element];
    vertices.insert(vertices.end(), element.begin(), element.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const auto number = [&](Index vertex) {
    return static_cast<Index>(std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin());
  };
  // Each vertex is there twice: as it is, and `opposite` further as what is on the other side.
  const auto opposite = static_cast<Index>(vertices.size());
  UnionFind sides(2 * vertices.size());
  const auto join = [&](Index a, Index b, bool same) {
    sides.join(a, same ? b : b + opposite);
    sides.join(a + opposite, same ? b + opposite : b);
  };
  for (const Index i : in_own_piece) {
    const Index own = number(points[i].vertices[0]);
    for (int k = 1; k < points[i].count; ++k) join(own, number(points[i].vertices[k]), true);
    for (const Index v : mesh_.elements()[points[i].query.element]) join(own, number(v), false);
  }
  std::vector<Index> tangles(2 * vertices.size(), kNone);  // the first member of each set
  for (const Index i : in_own_piece) {
    const Index own = number(points[i].vertices[0]);
    const Index here = sides.lowest(own), there = sides.lowest(own + opposite);
    if (here == there) continue;
    Index& tangle = tangles[std::min(here, there)];
    if (tangle == kNone) tangle = static_cast<Index>(members.size());
    members.push_back({tangle, i, here < there ? 1.0 : -1.0});
  }
}

/// From element to element, by the face that the ray leaves first.
BoundaryPath<3> CommonWaysOut::straight_way(std::span<const Vec3> positions, const Vec3& point, Index element,
                                            const Vec3& direction) const {
  BoundaryPath<3> path;
  Index from = kNone;
  double way = 0;
  for (int visited = 0; visited < kMaxElements; ++visited) {
    int exit = -1;
    double nearest = HUGE_VAL;
    for (int face = 0; face < 4; ++face) {
      if (mesh_.neighbours()[element][face].exists() && mesh_.neighbours()[element][face].element() == from) continue;
      const auto corners = corners_of(TetMesh::face_of(mesh_.elements()[element], face), positions);
      const Vec3 normal = area_normal(corners);
      const double speed = normal.dot(direction);
      if (!(speed > kParallel * normal.norm())) continue;
      const double at = normal.dot(corners[0] - point) / speed;
      if (at < nearest) nearest = at, exit = face;
    }
    if (exit < 0) return path;
    way = std::max(way, nearest);
    const HalfFace across = mesh_.neighbours()[element][exit];
    if (across.exists()) {
      from = element;
      element = across.element();
      continue;
    }
    path.face = across.boundary_face();
    path.point = point + way * direction;
    path.distance = way;
    path.normal = direction;
    const auto corners = corners_of(mesh_.boundary_faces()[path.face], positions);
    const Vec3 normal = area_normal(corners);
    for (int i = 0; i < 3; ++i) {
      const Vec3 &b = corners[(i + 1) % 3], &c = corners[(i + 2) % 3];
      path.barycentric[i] = std::clamp(normal.dot((c - b).cross(path.point - b)) / normal.squaredNorm(), 0.0, 1.0);
    }
    path.barycentric /= path.barycentric.sum();
    if (path.barycentric.allFinite() && path.point.allFinite()) path.status = PathStatus::kFound;
    return path;
  }
  return path;
}

/// Of the point's own piece, from the point on: what must come out after it.
double CommonWaysOut::length_behind(std::span<const Vec3> positions, const PenetratingPoint& point,
                                    const Vec3& direction) const {
  const auto has = [&](const VertexTuple<4>& element, Index v) {
    return std::find(element.begin(), element.end(), v) != element.end();
  };
  for (const Index e : mesh_.vertex_elements(point.vertices[0])) {
    const auto& element = mesh_.elements()[e];
    if (point.count > 1 && !has(element, point.vertices[1])) continue;
    // The direction leads into the element where it leads towards no face that the point is on.
    bool leads_in = true;
    for (int face = 0; face < 4; ++face) {
      const auto end = point.vertices.begin() + point.count;
      if (std::find(point.vertices.begin(), end, element[face]) != end) continue;
      leads_in &= area_normal(corners_of(TetMesh::face_of(element, face), positions)).dot(direction) < 0;
    }
    if (!leads_in) continue;
    const BoundaryPath<3> way = straight_way(positions, point.query.point, e, direction);
    return way.status == PathStatus::kFound ? way.distance : 0;
  }
  return 0;
}

/// Zero where the ways out agree.
Vec3 CommonWaysOut::best_direction(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                   std::span<const BoundaryPath<3>> paths, std::span<const Member> members) const {
  Vec3 sum = Vec3::Zero();
  double lengths = 0;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Member& member : members) {
    const BoundaryPath<3>& path = paths[member.point];
    if (path.status != PathStatus::kFound) continue;
    const Eigen::Vector3d way = member.side * (path.point - points[member.point].query.point);
    sum += way;
    lengths += way.norm();
    spread += way * way.transpose();
  }
  if (!(sum.norm() < kAgreement * lengths)) return Vec3::Zero();
  std::vector<Vec3> directions = directions_all_around();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  for (int k = 0; k < 3; ++k)
    for (const double sign : {1.0, -1.0}) directions.push_back(sign * axes.eigenvectors().col(k));
  Vec3 best = Vec3::Zero();
  double shortest = HUGE_VAL;
  const std::size_t stride = (members.size() + kSamples - 1) / kSamples;
  for (const Vec3& direction : directions) {
    double longest = 0;
    // Of a collider, which has no elements, what is inside.
    double last = HUGE_VAL;
    for (const Member& member : members)
      if (is_of_collider(points[member.point])) last = std::min(last, direction.dot(points[member.point].query.point));
    const auto behind = [&](const PenetratingPoint& point, const Vec3& ahead) {
      return is_of_collider(point) ? ahead.dot(point.query.point) - last : length_behind(positions, point, -ahead);
    };
    for (std::size_t i = 0; i < members.size() && longest < shortest; i += stride) {
      const PenetratingPoint& point = points[members[i].point];
      const Vec3 ahead = members[i].side * direction;
      const BoundaryPath<3> way = straight_way(positions, point.query.point, point.query.element, ahead);
      if (way.status == PathStatus::kFound) longest = std::max(longest, way.distance + behind(point, ahead));
    }
    if (longest < shortest) shortest = longest, best = direction;
  }
  return best;
}

void CommonWaysOut::apply(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                          std::span<BoundaryPath<3>> paths) const {
  const std::vector<Member> members = members_of(points);
  std::vector<std::span<const Member>> tangles;
  for (std::size_t first = 0, last = 0; first < members.size(); first = last) {
    while (last < members.size() && members[last].tangle == members[first].tangle) ++last;
    tangles.push_back(std::span(members).subspan(first, last - first));
  }
  parallel_for(std::ssize(tangles), 1, [&](std::int64_t t) {
    const Vec3 direction = best_direction(positions, points, paths, tangles[t]);
    if (direction.isZero(0)) return;
    for (const Member& member : tangles[t]) {
      const BoundaryPath<3> way = straight_way(positions, points[member.point].query.point,
                                               points[member.point].query.element, member.side * direction);
      if (way.status == PathStatus::kFound) paths[member.point] = way;
    }
  });
}

}  // namespace selvage
