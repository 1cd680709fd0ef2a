#pragma once

#include "selvage/boundary_path/path_query.h"
#include "selvage/core/types.h"
#include "selvage/mesh/simplex_mesh.h"

#include <memory>

namespace selvage {

template <int D>
struct LocatorImpl;
template <int D>
class BoundaryPathFinder;

/// Elements that hold each of some points: those of point i are queries first[i] to first[i + 1] - 1, ascending by
/// element.
template <int D>
struct LocatedPoints {
  std::vector<PathQuery<D>> queries;
  std::vector<std::int64_t> first;  ///< n_points + 1 entries
};

/// Elements, or boundary faces, near each of some boxes: those of box i are found[first[i]] to found[first[i + 1] - 1].
struct NearbyItems {
  std::vector<Index> found;
  std::vector<std::int64_t> first;  ///< n_boxes + 1 entries
};

/// Where a pose is not locally injective: where the theorems of SPB do not hold.
struct MeshDefects {
  std::int64_t inverted_elements = 0;
  std::int64_t degenerate_elements = 0;
  /// Interior ridges (edges in 3D, vertices in 2D) around which the elements turn twice or more (angles sum to 4 pi).
  std::int64_t overwound_interior_ridges = 0;
  /// Boundary ridges around which the elements turn by more than 2 pi.
  std::int64_t overwound_boundary_ridges = 0;
};

/// Elements of a mesh that hold a point, in the plane and in space: all of them, where the mesh overlaps itself.
///
/// Points on a face, an edge or a vertex are in every element that has it; every answer is decided exactly. Flat
/// elements hold nothing. Holds a hierarchy over the elements; positions are handed in with every new pose and copied.
/// Thread-safe for concurrent queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include point_locator.cpp
template <int D>
class PointLocator {
 public:
  /// @param mesh       topology; must outlive the locator
  /// @param positions  (n_vertices x D) [m]
  /// @throws Error     when the mesh has no element, sizes differ, or a position is not finite; so do update() and
  ///                   rebuild()
  PointLocator(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions);
  PointLocator(const SimplexMesh<D>&& mesh, std::span<const Vec<D>> positions) = delete;
  ~PointLocator();
  PointLocator(PointLocator&&) noexcept;
  PointLocator& operator=(PointLocator&&) noexcept;

  /// Takes a new pose: refits the hierarchy in O(n), and rebuilds it when its quality has become poor. Parallel.
  void update(std::span<const Vec<D>> positions);

  /// Takes a new pose and builds the hierarchy anew. O(n log n), parallel.
  void rebuild(std::span<const Vec<D>> positions);

  /// Elements that hold each point. O(log n) expected per point, parallel.
  /// @throws Error  when a point is not finite
  LocatedPoints<D> locate(std::span<const Vec<D>> points) const;

  /// Pairs of a vertex, on the boundary or not, and an element that holds it and does not have it; ascending by vertex,
  /// then element. Parallel.
  /// @throws Error  when a vertex is out of range
  std::vector<PathQuery<D>> locate_vertices(std::span<const Index> vertices) const;

  /// Vertex-element DCD: the same pairs for all boundary vertices, ready for BoundaryPathFinder::find_paths(). Inverted
  /// elements on the boundary are skipped (SPB section 3.5). Parallel.
  std::vector<PathQuery<D>> find_penetrating_vertices() const;

  /// Elements that a box may meet: all that do and a few that lie near it, in a fixed order. Parallel.
  /// @param boxes  lower and upper corner of each [m]
  NearbyItems find_elements_near(std::span<const std::array<Vec<D>, 2>> boxes) const;

  /// Defects of the current pose.
  const MeshDefects& defects() const;

  /// Elements of the current pose that are inverted or flat, ascending.
  std::span<const Index> defective_elements() const;

  /// (n_vertices) 1 where the elements around the vertex are proven to overlap nowhere but at common points, provided
  /// that none of them is defective; 0 elsewhere.
  std::span<const std::uint8_t> locally_injective_vertices() const;

 private:
  friend class BoundaryPathFinder<D>;
  explicit PointLocator(std::shared_ptr<LocatorImpl<D>> impl);

  std::shared_ptr<LocatorImpl<D>> impl_;  ///< a BoundaryPathFinder has it in common with its locator
};

extern template class PointLocator<2>;
extern template class PointLocator<3>;

}  // namespace selvage
