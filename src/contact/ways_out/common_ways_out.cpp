#include "contact/ways_out/common_ways_out.h"

#include "contact/ways_out/straight_way.h"
#include "core/parallel.h"
#include "core/union_find.h"
#include "mesh/limb_ends.h"
#include "mesh/simplex_corners.h"

#include <algorithm>
#include <cmath>

namespace selvage {

namespace {

/// Length of the sum of all ways out over the sum of their lengths, below which they disagree.
constexpr double kAgreement = 0.5;
/// Points of a tangle by which directions are compared.
constexpr std::size_t kSamples = 64;
/// Cosine of the angle to the way of a tangle's shorter end from which on a direction presses this end on.
constexpr double kAgainstEnd = -0.03;

}  // namespace

CommonWaysOut::CommonWaysOut(const TetMesh& mesh) : mesh_(mesh), pieces_(mesh.element_components()) {}

Index CommonWaysOut::piece_of(const PenetratingPoint& point) const {
  if (is_of_collider(point)) return kNone;
  const auto elements = mesh_.vertex_elements(point.vertices[0]);
  return elements.empty() ? kNone : pieces_[elements.front()];
}

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
    const Index own = piece_of(point), other = pieces_[point.query.element];
    if (own == kNone) continue;
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

std::vector<Index> CommonWaysOut::vertices_in_folds(std::span<const PenetratingPoint> points) const {
  std::vector<Index> in_own_piece, in_others;
  for (Index i = 0; i < std::ssize(points); ++i) {
    const Index own = piece_of(points[i]), other = pieces_[points[i].query.element];
    if (own == other) {
      in_own_piece.push_back(i);
    } else if (own != kNone) {
      in_others.insert(in_others.end(), {own, other});
    }
  }
  std::sort(in_others.begin(), in_others.end());
  std::erase_if(in_own_piece, [&](Index i) {
    return std::binary_search(in_others.begin(), in_others.end(), pieces_[points[i].query.element]);
  });
  std::vector<Member> members;
  append_members_in_own_piece(points, in_own_piece, members);
  std::vector<Index> vertices;
  auto member = members.begin();  // in the order of points
  for (const Index i : in_own_piece) {
    if (member != members.end() && member->point == i) {
      ++member;
      continue;
    }
    vertices.insert(vertices.end(), points[i].vertices.begin(), points[i].vertices.begin() + points[i].count);
    const auto& element = mesh_.elements()[points[i].query.element];
    vertices.insert(vertices.end(), element.begin(), element.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
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
    const BoundaryPath<3> way = straight_way(mesh_, positions, point.query.point, e, direction);
    return way.status == PathStatus::kFound ? way.distance : 0;
  }
  return 0;
}

/// Of each tangle of a piece with itself, the direction in which its members draw the shorter end after them; zero
/// where none is cut off.
std::vector<Vec3> CommonWaysOut::ways_of_ends(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                              std::span<const std::span<const Member>> tangles) const {
  std::vector<Vec3> ways(tangles.size(), Vec3::Zero());
  std::vector<Index> regions;  // two for each tangle: the vertices of its sides
  for (std::size_t t = 0; t < tangles.size(); ++t) {
    const PenetratingPoint& first = points[tangles[t].front().point];
    if (piece_of(first) != pieces_[first.query.element]) continue;
    regions.resize(mesh_.vertex_count(), kNone);
    for (const Member& member : tangles[t]) {
      const PenetratingPoint& point = points[member.point];
      const auto own = static_cast<Index>(2 * t + (member.side > 0 ? 0 : 1));
      for (int k = 0; k < point.count; ++k) regions[point.vertices[k]] = own;
      for (const Index v : mesh_.elements()[point.query.element]) regions[v] = own ^ 1;
    }
  }
  if (regions.empty()) return ways;
  std::vector<std::int64_t> shortest(tangles.size());
  for (const auto& [region, end] : find_limb_ends(mesh_, positions.first(mesh_.vertex_count()), regions)) {
    const std::size_t t = region / 2;
    if (shortest[t] != 0 && shortest[t] <= end.vertices) continue;
    shortest[t] = end.vertices;
    ways[t] = region % 2 == 0 ? end.way : Vec3(-end.way);
  }
  return ways;
}

/// Zero where the ways out agree.
Vec3 CommonWaysOut::best_direction(std::span<const Vec3> positions, std::span<const PenetratingPoint> points,
                                   std::span<const BoundaryPath<3>> paths, std::span<const Member> members,
                                   const Vec3& way_of_end) const {
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
  const bool agree = !(sum.norm() < kAgreement * lengths);
  if (agree && !(sum.dot(way_of_end) < kAgainstEnd * sum.norm())) return Vec3::Zero();
  Vec3 best = Vec3::Zero();
  double shortest = HUGE_VAL;
  const std::size_t stride = (members.size() + kSamples - 1) / kSamples;
  for (const Vec3& direction : directions_to_try(spread)) {
    if (direction.dot(way_of_end) < kAgainstEnd) continue;
    double longest = 0;
    for (std::size_t i = 0; i < members.size() && longest < shortest; i += stride) {
      const PenetratingPoint& point = points[members[i].point];
      const Vec3 ahead = members[i].side * direction;
      const BoundaryPath<3> way = straight_way(mesh_, positions, point.query.point, point.query.element, ahead);
      if (way.status == PathStatus::kFound)
        longest = std::max(longest, way.distance + length_behind(positions, point, -ahead));
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
  const std::vector<Vec3> ends = ways_of_ends(positions, points, tangles);
  parallel_for(std::ssize(tangles), 1, [&](std::int64_t t) {
    const Vec3 direction = best_direction(positions, points, paths, tangles[t], ends[t]);
    if (direction.isZero(0)) return;
    for (const Member& member : tangles[t]) {
      const BoundaryPath<3> way = straight_way(mesh_, positions, points[member.point].query.point,
                                               points[member.point].query.element, member.side * direction);
      if (way.status == PathStatus::kFound) paths[member.point] = way;
    }
  });
}

}  // namespace selvage
