#pragma once

#include "selvage/mesh/triangle_mesh.h"

#include <memory>

namespace selvage {

/// The smallest part of a surface that holds a point.
enum class SurfaceFeature : std::uint8_t { kFace, kEdge, kVertex };

/// The point of a surface that is closest to a given point.
struct SurfacePoint {
  Index triangle = kNone;  ///< the smallest index where several triangles share the closest point
  SurfaceFeature feature = SurfaceFeature::kFace;
  Index feature_index = kNone;          ///< of the triangle, the edge or the vertex that is the feature
  std::array<double, 3> barycentric{};  ///< of `point` in the triangle's vertices; exactly 0 off the feature
  Vec3 point = Vec3::Zero();            ///< [m]
  double distance = 0;                  ///< not negative [m]
};

/// On which side of a closed surface a point lies, decided exactly.
struct SurfaceSide {
  /// How many times the surface encloses the point: 1 inside a surface whose normals point outward, 0 outside, -1
  /// inside one that is turned inside out, 2 where two parts of it overlap. 0 on the surface.
  std::int32_t winding_number = 0;
  bool is_on_surface = false;

  bool operator==(const SurfaceSide&) const = default;
};

/// The signed distance of a point from a closed surface.
struct SignedDistance {
  double distance = 0;  ///< negative where the winding number is not 0, exactly 0 on the surface [m]
  SurfaceSide side;
  SurfacePoint closest;
};

/// Closest points on a triangle surface, and distances from it, signed where it is closed.
///
/// Any surface is legal: open, closed, of several components, non-manifold, self-intersecting, with degenerate
/// triangles. Closest points are computed in doubles, see closest_point_on_triangle(); no triangle is missed. Signs are
/// exact: they come from winding numbers, which count the crossings of a ray by exact predicates, and not from normals,
/// which fail at non-manifold edges and self-intersections (Jacobson, Kavan, Sorkine-Hornung 2013).
///
/// Holds the hierarchy of one surface. Positions are given with every new pose and copied. Thread-safe for concurrent
/// queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include surface_distance.cpp
class SurfaceDistance {
 public:
  /// No coordinate of a surface or a point may be larger in magnitude: its square would overflow.
  static constexpr double kMaxCoordinate = 0x1p500;

  /// @param mesh       topology; must outlive the object: a temporary is refused
  /// @param positions  (n_vertices x 3) [m]
  /// @throws Error     when the mesh has no triangle, sizes differ, or a position is not finite or too large; update()
  ///                   and rebuild() likewise
  SurfaceDistance(const TriangleMesh& mesh, std::span<const Vec3> positions);
  SurfaceDistance(const TriangleMesh&&, std::span<const Vec3>) = delete;
  ~SurfaceDistance();
  SurfaceDistance(SurfaceDistance&&) noexcept;
  SurfaceDistance& operator=(SurfaceDistance&&) noexcept;

  /// Takes a new pose: refits the hierarchy in O(n), and rebuilds it when its quality has become poor.
  void update(std::span<const Vec3> positions);

  /// Takes a new pose and builds the hierarchy anew.
  void rebuild(std::span<const Vec3> positions);

  /// Whether the surface has an inside: as many triangles run along each edge in one direction as in the other. Each
  /// edge of an oriented surface without border has two such triangles.
  bool is_closed() const;

  /// Closest points, one a point, in the order of the points. O(log n) expected a point; parallel; the same bits for
  /// any number of threads.
  /// @param points  (n_points x 3) [m]
  /// @throws Error  when a coordinate is not finite or too large
  std::vector<SurfacePoint> find_closest_points(std::span<const Vec3> points) const;

  /// The side of each point, without its distance. O(log n + triangles above the point) expected a point;
  /// parallel.
  /// @throws Error  when the surface is not closed, or a coordinate is not finite or too large
  std::vector<SurfaceSide> find_sides(std::span<const Vec3> points) const;

  /// Signed distances: find_closest_points() and find_sides() together. Where the surface intersects itself, the
  /// closest point may lie inside it, on a part that another part encloses.
  /// @throws Error  as find_sides()
  std::vector<SignedDistance> find_signed_distances(std::span<const Vec3> points) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
