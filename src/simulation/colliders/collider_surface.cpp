#include "simulation/colliders/collider_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace selvage {

namespace {

/// Parts of the element size: by which the surface lies behind the collider's; by which a polygon may cut off a round
/// side; the radius from which on a round side is wide: there a flat element reaches in by at most 1/48 of its size.
constexpr double kInset = 0.005, kCutOff = 0.01, kWideRadius = 6;
/// Of a thin shape: the part of its thickness by which the surface may lie behind it.
constexpr double kThinInset = 0.0625;
/// Triangles with an edge longer than this, in element sizes, are represented by the strips along their edges.
constexpr double kLargeTriangle = 2;
/// Sine of the angle between two triangles below which the edge between them is flat.
constexpr double kFlat = 0.01;
/// Parts into which all edges of a collider are divided, at most: the size of the surface is bounded, whatever the
/// proportion of colliders to elements.
constexpr double kMaxParts = 200'000;

class Builder {
 public:
  explicit Builder(double element_size) : size_(element_size) {}

  ColliderSurface take() { return std::move(surface_); }

  void add_whole(Index collider, const MeshCollider& mesh) {
    const auto first = static_cast<Index>(surface_.positions.size());
    surface_.positions.insert(surface_.positions.end(), mesh.positions().begin(), mesh.positions().end());
    surface_.collider_of_vertices.resize(surface_.positions.size(), collider);
    for (const auto& [a, b, c] : mesh.mesh().triangles()) triangle(first + a, first + b, first + c);
  }

  void add(Index collider, const auto& shape) {
    add_shape(shape);
    surface_.collider_of_vertices.resize(surface_.positions.size(), collider);
  }

 private:
  void add_shape(const PlaneShape& /*plane*/) {}
  void add_shape(const Bowl& bowl);
  void add_shape(const SphereShape& sphere);
  void add_shape(const CylinderShape& cylinder);
  void add_shape(const MeshCollider& mesh);

  Index point(const Vec3& position) {
    surface_.positions.push_back(position);
    return static_cast<Index>(surface_.positions.size()) - 1;
  }
  void triangle(Index a, Index b, Index c) { surface_.triangles.push_back({a, b, c}); }
  void quad(Index a, Index b, Index c, Index d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }

  /// Parts of a length, none longer than an element.
  int parts_of(double length, double total) const {
    return static_cast<int>(std::max(1.0, std::ceil(length / std::max(size_, total / kMaxParts))));
  }
  /// Sides of a polygon for a circle: none longer than an element, and close to the circle.
  int sides_of(double radius) const {
    const double by_height = std::numbers::pi / std::acos(std::max(1 - kCutOff * size_ / radius, 0.5));
    const double by_length = parts_of(2 * std::numbers::pi * radius, 2 * std::numbers::pi * radius);
    return static_cast<int>(std::ceil(std::max(by_height, by_length)));
  }
  double inset_of(double thickness) const { return std::min(kInset * size_, kThinInset * thickness); }

  double size_;
  ColliderSurface surface_;
};

/// The edge of the rim, with strips of the flat around it and of the wall below.
void Builder::add_shape(const Bowl& bowl) {
  const auto [u, v] = across(bowl.axis);
  const double inset = inset_of(bowl.radius);
  const double strip = std::min(size_, bowl.radius / 2);
  const int sides = sides_of(bowl.radius);
  std::vector<std::array<Index, 3>> rings;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vec3 out = std::cos(angle) * u + std::sin(angle) * v;
    // Chords lie inside the circle, where the bowl is hollow: the corners are farther out.
    const double radius = (bowl.radius + inset) / std::cos(std::numbers::pi / sides);
    const Vec3 rim = bowl.centre - inset * bowl.axis;
    // The wall curves inwards below: the strip goes straight down, behind it.
    rings.push_back({point(rim + (radius + strip) * out), point(rim + radius * out),
                     point(rim + radius * out - strip * bowl.axis)});
  }
  for (int i = 0; i < sides; ++i) {
    const auto &a = rings[i], &b = rings[(i + 1) % sides];
    quad(a[0], b[0], b[1], a[1]);
    quad(a[1], b[1], b[2], a[2]);
  }
}

/// An icosahedron, its triangles divided until they are near the sphere.
void Builder::add_shape(const SphereShape& sphere) {
  if (sphere.radius >= kWideRadius * size_) return;
  const double golden = std::numbers::phi;
  std::vector<Vec3> points;
  for (const double a : {-1.0, 1.0})
    for (const double b : {-golden, golden})
      for (const Vec3& p : {Vec3(0, a, b), Vec3(a, b, 0), Vec3(b, 0, a)}) points.push_back(p.normalized());
  std::vector<VertexTuple<3>> triangles;
  for (Index a = 0; a < 12; ++a)
    for (Index b = a + 1; b < 12; ++b)
      for (Index c = b + 1; c < 12; ++c) {
        const Vec3 &p = points[a], &q = points[b], &r = points[c];
        constexpr double kEdge = 1.1;  // on the unit sphere edges are 1.05 long, diagonals 1.7
        if ((p - q).norm() > kEdge || (q - r).norm() > kEdge || (r - p).norm() > kEdge) continue;
        const bool outward = (q - p).cross(r - p).dot(p) > 0;
        triangles.push_back(outward ? VertexTuple<3>{a, b, c} : VertexTuple<3>{a, c, b});
      }
  const double side = std::sqrt(8 * kCutOff * size_ * sphere.radius);
  for (double edge = 1.06 * sphere.radius; edge > side; edge /= 2) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [place, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(points.size()));
      if (is_new) points.push_back((points[a] + points[b]).normalized());
      return place->second;
    };
    std::vector<VertexTuple<3>> divided;
    for (const auto& [a, b, c] : triangles) {
      const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      divided.insert(divided.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    triangles = std::move(divided);
  }
  const double radius = sphere.radius - inset_of(sphere.radius);
  const auto first = static_cast<Index>(surface_.positions.size());
  for (const Vec3& p : points) point(sphere.centre + radius * p);
  for (const auto& [a, b, c] : triangles) triangle(first + a, first + b, first + c);
}

/// The edges of both ends and, of a narrow one, the side.
void Builder::add_shape(const CylinderShape& cylinder) {
  const Vec3 u = cylinder.axis.unitOrthogonal(), v = cylinder.axis.cross(u);
  const double inset = inset_of(std::min(cylinder.radius, cylinder.length));
  const double radius = cylinder.radius - inset, half = cylinder.length / 2 - inset;
  const int sides = sides_of(cylinder.radius);
  const bool is_wide = cylinder.radius >= kWideRadius * size_;
  const double strip = std::min({size_, radius / 2, half});
  const int parts = parts_of(2 * half, sides * 2 * half);
  std::vector<double> heights;
  if (is_wide) {
    heights = {-half, -half + strip, half - strip, half};
  } else {
    for (int k = 0; k <= parts; ++k) heights.push_back(half * (2.0 * k / parts - 1));
  }
  std::vector<std::vector<Index>> rings;
  const auto add_ring = [&](double r, double height) {
    std::vector<Index>& ring = rings.emplace_back();
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides;
      ring.push_back(point(cylinder.centre + height * cylinder.axis + r * (std::cos(angle) * u + std::sin(angle) * v)));
    }
  };
  add_ring(radius - strip, -half);
  for (const double height : heights) add_ring(radius, height);
  add_ring(radius - strip, half);
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    if (is_wide && k == 2) continue;
    for (int i = 0; i < sides; ++i) {
      const int next = (i + 1) % sides;
      quad(rings[k][i], rings[k][next], rings[k + 1][next], rings[k + 1][i]);
    }
  }
}

/// A mesh's vertices and edges, moved inward from all triangles around.
class InsetMesh {
 public:
  InsetMesh(const MeshCollider& mesh, double inset) : mesh_(mesh), inset_(inset) {}

  Vec3 normal(Index t) const {
    const auto [a, b, c] = mesh_.corners(t);
    return (b - a).cross(c - a).normalized();
  }

  /// A point on some triangles, as far behind all of their planes as the inset, where there is room.
  Vec3 move_inward(const Vec3& p, std::span<const Index> triangles) const {
    // Where planes are nearly parallel, the regular term keeps the move short.
    constexpr double kRegular = 1e-3, kMaxMove = 3;
    Eigen::Matrix3d sum = kRegular * Eigen::Matrix3d::Identity();
    Vec3 right = Vec3::Zero();
    for (const Index t : triangles) {
      const Vec3 n = normal(t);
      if (!n.allFinite()) continue;
      sum += n * n.transpose();
      right -= inset_ * n;
    }
    Vec3 move = sum.ldlt().solve(right);
    const double length = move.norm();
    if (length > kMaxMove * inset_) move *= kMaxMove * inset_ / length;
    // In a thin place: as long as a way several times as long does not leave the solid.
    constexpr int kHalvings = 12;
    for (int i = 0; i < kHalvings; ++i, move /= 2)
      if (mesh_.find_hit(p + move / (2 * kThinInset))) return p + move;
    return p;
  }

 private:
  const MeshCollider& mesh_;
  double inset_;
};

/// A point of a triangle from which a strip along an edge is made: at most so far from the edge.
Vec3 inner_point(const Vec3& on_edge, const Vec3& along, const Vec3& centre, double farthest) {
  const Vec3 way = centre - on_edge;
  const double height = (way - way.dot(along) * along).norm();
  return on_edge + std::min(2.0 / 3, farthest / height) * way;
}

void Builder::add_shape(const MeshCollider& collider) {
  const TriangleMesh& mesh = collider.mesh();
  const InsetMesh inset(collider, kInset * size_);
  const auto length_of = [&](Index e) {
    const auto& [a, b] = mesh.edges()[e];
    return (collider.positions()[a] - collider.positions()[b]).norm();
  };
  const auto is_flat = [&](Index e) {
    const auto triangles = mesh.edge_triangles(e);
    return inset.normal(triangles[0]).cross(inset.normal(triangles[1])).norm() < kFlat &&
           inset.normal(triangles[0]).dot(inset.normal(triangles[1])) > 0;
  };
  double total = 0;
  for (Index e = 0; e < mesh.edge_count(); ++e)
    if (!is_flat(e)) total += length_of(e);

  std::vector<Index> vertices(collider.positions().size(), kNone);
  const auto vertex = [&](Index v) {
    if (vertices[v] == kNone) vertices[v] = point(inset.move_inward(collider.positions()[v], mesh.vertex_triangles(v)));
    return vertices[v];
  };
  // Of each edge the points that divide it, from its first vertex to its second.
  std::vector<std::vector<Index>> divided(mesh.edge_count());
  const auto divide = [&](Index e) -> const std::vector<Index>& {
    if (!divided[e].empty()) return divided[e];
    const auto& [a, b] = mesh.edges()[e];
    const int parts = parts_of(length_of(e), total);
    divided[e].push_back(vertex(a));
    for (int i = 1; i < parts; ++i) {
      const double place = static_cast<double>(i) / parts;
      const Vec3 p = (1 - place) * collider.positions()[a] + place * collider.positions()[b];
      divided[e].push_back(point(inset.move_inward(p, mesh.edge_triangles(e))));
    }
    divided[e].push_back(vertex(b));
    return divided[e];
  };

  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const auto& corners = mesh.triangles()[t];
    const auto& edges = mesh.triangle_edges()[t];
    if (std::all_of(edges.begin(), edges.end(), is_flat)) continue;
    if (std::none_of(edges.begin(), edges.end(), [&](Index e) { return length_of(e) > kLargeTriangle * size_; })) {
      triangle(vertex(corners[0]), vertex(corners[1]), vertex(corners[2]));
      continue;
    }
    const auto [a, b, c] = collider.corners(t);
    const Vec3 centre = (a + b + c) / 3;
    for (int i = 0; i < 3; ++i) {
      if (is_flat(edges[i])) continue;
      const std::vector<Index> points = divide(edges[i]);
      const bool is_forward = mesh.edges()[edges[i]][0] == corners[(i + 1) % 3];
      const auto& [from, to] = mesh.edges()[edges[i]];
      const Vec3 way_along = (collider.positions()[to] - collider.positions()[from]).normalized();
      const auto parts = static_cast<int>(points.size()) - 1;
      for (int k = 0; k < parts; ++k) {
        const double place = (k + 0.5) / parts;
        const Vec3 middle = (1 - place) * collider.positions()[from] + place * collider.positions()[to];
        const Index inner = point(inset.move_inward(inner_point(middle, way_along, centre, size_), {&t, 1}));
        if (is_forward) {
          triangle(points[k], points[k + 1], inner);
        } else {
          triangle(points[k + 1], points[k], inner);
        }
      }
    }
  }
}

}  // namespace

std::vector<VertexTuple<3>> ColliderSurface::triangles_after(Index vertex_count) const {
  std::vector<VertexTuple<3>> following = triangles;
  for (auto& triangle : following)
    for (Index& v : triangle) v += vertex_count;
  return following;
}

double element_size_of(const Model& model) {
  double least = 0;
  for (const Body& body : model.bodies) {
    if (body.element_count + body.triangle_count == 0) continue;
    const double mean = mean_edge_of(model, body);
    if (least == 0 || mean < least) least = mean;
  }
  return least;
}

ColliderSurface make_collider_surface(std::span<const PreparedCollider> colliders, double element_size) {
  Builder builder(element_size);
  for (std::size_t c = 0; c < colliders.size() && element_size > 0; ++c) {
    if (colliders[c].surface_motion) {
      builder.add_whole(static_cast<Index>(c), std::get<MeshCollider>(colliders[c].shape));
    } else {
      std::visit([&](const auto& shape) { builder.add(static_cast<Index>(c), shape); }, colliders[c].shape);
    }
  }
  ColliderSurface surface = builder.take();
  place_keyframed(colliders, element_size, surface);
  return surface;
}

void place_keyframed(std::span<const PreparedCollider> colliders, double element_size, ColliderSurface& surface) {
  if (std::ranges::none_of(colliders, [](const PreparedCollider& c) { return c.surface_motion != nullptr; })) return;
  surface.start_positions.resize(surface.positions.size());
  for (std::size_t i = 0; i < surface.positions.size();) {
    const PreparedCollider& collider = colliders[surface.collider_of_vertices[i]];
    if (!collider.surface_motion) {
      surface.start_positions[i] = surface.positions[i];
      ++i;
      continue;
    }
    const auto& end = std::get<MeshCollider>(collider.shape);
    std::ranges::copy(inset_positions(collider.surface_motion->start(), kInset * element_size),
                      surface.start_positions.begin() + static_cast<std::ptrdiff_t>(i));
    std::ranges::copy(inset_positions(end, kInset * element_size),
                      surface.positions.begin() + static_cast<std::ptrdiff_t>(i));
    i += end.positions().size();
  }
}

}  // namespace selvage
