#include "simulation/colliders/mesh_collider.h"

#include "bvh/traverse.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <utility>

namespace selvage {

namespace {

/// The same triangles with one vertex for each place.
MeshShape join_corners(const MeshShape& shape) {
  const auto& positions = shape.positions;
  std::vector<Index> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) { return before(positions[a], positions[b]); });
  MeshShape joined;
  std::vector<Index> place_of(positions.size());
  for (const Index v : order) {
    if (joined.positions.empty() || joined.positions.back() != positions[v]) joined.positions.push_back(positions[v]);
    place_of[v] = static_cast<Index>(joined.positions.size()) - 1;
  }
  for (const auto& [a, b, c] : shape.triangles) {
    const VertexTuple<3> triangle{place_of[a], place_of[b], place_of[c]};
    const bool is_line = triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
    if (!is_line) joined.triangles.push_back(triangle);
  }
  return joined;
}

TriangleMesh surface_of(const std::string& where, const MeshShape& shape) {
  for (const Vec3& p : shape.positions)
    if (!p.allFinite()) throw Error(where, "a position of its mesh is not finite");
  try {
    return {static_cast<Index>(shape.positions.size()), shape.triangles};
  } catch (const Error& error) {
    throw Error(where, error.what());
  }
}

void check_closed(const std::string& where, const TriangleMesh& mesh) {
  for (Index e = 0; e < mesh.edge_count(); ++e)
    if (mesh.edge_triangles(e).size() != 2)
      throw Error(where,
                  fmt::format("the edge of its vertices {} and {} has {} triangles", mesh.edges()[e][0],
                              mesh.edges()[e][1], mesh.edge_triangles(e).size()),
                  "give a closed surface, on which each has two");
}

/// A connected piece of a closed surface.
struct SurfacePiece {
  double volume = 0;  ///< times 6; negative where triangles face inwards
  double size = 0;    ///< sum of the terms of the volume without their signs
  Eigen::AlignedBox3d box;

  void add(const Vec3& origin, const std::array<Vec3, 3>& corners) {
    const double part = (corners[0] - origin).dot((corners[1] - origin).cross(corners[2] - origin));
    volume += part;
    size += std::abs(part);
    for (const Vec3& p : corners) box.extend(p);
  }
  bool faces_inwards() const { return volume < -1e-12 * size; }
};

std::vector<SurfacePiece> pieces_of(const TriangleMesh& mesh, std::span<const Vec3> positions) {
  std::vector<SurfacePiece> pieces;
  std::vector<std::uint8_t> seen(mesh.triangle_count(), 0);
  for (Index first = 0; first < mesh.triangle_count(); ++first) {
    if (seen[first]) continue;
    SurfacePiece& piece = pieces.emplace_back();
    std::vector<Index> open{first};
    seen[first] = 1;
    while (!open.empty()) {
      const Index t = open.back();
      open.pop_back();
      const auto& [a, b, c] = mesh.triangles()[t];
      piece.add(positions[mesh.triangles()[first][0]], {positions[a], positions[b], positions[c]});
      for (const HalfFace across : mesh.neighbours()[t])
        if (!std::exchange(seen[across.element()], 1)) open.push_back(across.element());
    }
  }
  return pieces;
}

/// A surface that faces inwards would hold back no vertex. Only the wall of a hollow inside another piece may.
void check_outward(const std::string& where, const TriangleMesh& mesh, std::span<const Vec3> positions) {
  if (!mesh.is_oriented())
    throw Error(where, "its triangles do not agree on which side is outside", "turn those round that face inwards");
  const std::vector<SurfacePiece> pieces = pieces_of(mesh, positions);
  for (const SurfacePiece& piece : pieces)
    if (piece.faces_inwards() && std::none_of(pieces.begin(), pieces.end(), [&](const SurfacePiece& other) {
          return &other != &piece && !other.faces_inwards() && other.box.contains(piece.box);
        }))
      throw Error(where, "its triangles face inwards", "turn them round");
}

}  // namespace

MeshCollider::MeshCollider(const std::string& where, const MeshShape& shape)
    : positions_(shape.positions), mesh_(surface_of(where, shape)) {
  if (positions_.size() == 3 * shape.triangles.size()) {  // each triangle has its own: so it is in STL
    MeshShape joined = join_corners(shape);
    mesh_ = surface_of(where, joined);
    positions_ = std::move(joined.positions);
  }
  check_closed(where, mesh_);
  check_outward(where, mesh_, positions_);
  set_positions(std::move(positions_));
}

void MeshCollider::set_positions(std::vector<Vec3> positions) {
  positions_ = std::move(positions);
  bounds_.setEmpty();
  for (const Vec3& p : positions_) bounds_.extend(p);
  std::vector<Box> boxes;
  triangle_normals_.clear();
  edge_normals_.assign(mesh_.edge_count(), Vec3::Zero());
  vertex_normals_.assign(positions_.size(), Vec3::Zero());
  for (Index t = 0; t < mesh_.triangle_count(); ++t) {
    const auto& triangle = mesh_.triangles()[t];
    const std::array<Vec3, 3> corners{positions_[triangle[0]], positions_[triangle[1]], positions_[triangle[2]]};
    boxes.push_back(bounding_box<3>(corners));
    const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    triangle_normals_.push_back(normal);
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = corners[(i + 1) % 3] - corners[i], b = corners[(i + 2) % 3] - corners[i];
      edge_normals_[mesh_.triangle_edges()[t][i]] += normal;
      vertex_normals_[triangle[i]] += std::atan2(a.cross(b).norm(), a.dot(b)) * normal;
    }
  }
  bvh_ = Bvh(boxes);
}

void MeshCollider::set_buried(std::vector<std::uint8_t> is_buried) {
  const auto count = std::count(is_buried.begin(), is_buried.end(), 0);
  if (count > 0 && count < std::ssize(is_buried)) is_buried_ = std::move(is_buried);
}

SurfacePlace MeshCollider::find_nearest(const Vec3& p) const {
  return find_nearest(p, [](Index) { return true; });
}

/// @param counts  of a triangle, whether it does
template <typename Counts>
SurfacePlace MeshCollider::find_nearest(const Vec3& p, Counts&& counts) const {
  SurfacePlace nearest;
  nearest.point.squared_distance = std::numeric_limits<double>::infinity();
  visit_nearest(bvh_.nodes(), enclosing_box<3>(p, p), std::numeric_limits<float>::infinity(), [&](Index t, float) {
    if (!counts(t)) return round_up(nearest.point.squared_distance);
    const auto [a, b, c] = corners(t);
    const auto found = closest_point_on_triangle(p, a, b, c);
    if (found.squared_distance < nearest.point.squared_distance) nearest = {t, found};
    return round_up(nearest.point.squared_distance);
  });
  return nearest;
}

Vec3 MeshCollider::normal_at(const SurfacePlace& place) const {
  const unsigned mask = place.point.vertex_mask;
  if (std::popcount(mask) == 2) return edge_normals_[mesh_.triangle_edges()[place.triangle][std::countr_one(mask)]];
  if (std::popcount(mask) == 1) return vertex_normals_[mesh_.triangles()[place.triangle][std::countr_zero(mask)]];
  return triangle_normals_[place.triangle];
}

std::optional<Hit> MeshCollider::find_hit(const Vec3& p, double distance) const {
  if (bounds_.squaredExteriorDistance(p) > distance * distance) return {};
  SurfacePlace nearest = find_nearest(p);
  Vec3 normal = normal_at(nearest), way = nearest.point.point - p;
  const bool is_inside = way.dot(normal) > 0;
  if (is_inside && !is_buried_.empty() && is_buried_[nearest.triangle] != 0) {
    nearest = find_nearest(p, [&](Index t) { return is_buried_[t] == 0; });
    normal = normal_at(nearest);
    way = nearest.point.point - p;
  }
  const double length = way.norm();
  if (!is_inside && length >= distance) return {};
  // The way to a surface on which the point lies but for rounding has no direction of its own.
  constexpr double kOnSurface = 1e-6;
  const bool lies_on = length <= kOnSurface * distance;
  const Vec3 out = lies_on ? Vec3(normal.normalized()) : is_inside ? Vec3(way / length) : Vec3(-way / length);
  return Hit{out, is_inside ? distance + length : distance - length};
}

}  // namespace selvage
