#pragma once

#include "selvage/boundary_path/path_query.h"
#include "selvage/boundary_path/point_locator.h"
#include "selvage/core/types.h"
#include "selvage/mesh/simplex_mesh.h"

#include <memory>

namespace selvage {

/// Outcome of a query.
enum class PathStatus : std::uint8_t {
  kFound,         ///< the shortest path is given
  kNoPath,        ///< every candidate is blocked, or none is left
  kNotInElement,  ///< the point does not lie in the element it was said to be in, or the element is exactly flat
};

/// Where on the boundary face the closest boundary point lies.
enum class BoundaryFeature : std::uint8_t { kFace, kEdge, kVertex };

/// The shortest path from a query's point to the boundary. Only `status` has a meaning unless it is kFound.
template <int D>
struct BoundaryPath {
  PathStatus status = PathStatus::kNoPath;
  BoundaryFeature feature = BoundaryFeature::kFace;
  Index face = kNone;   ///< boundary face; the smallest index where several share the closest point
  Vec<D> barycentric;   ///< of `point` in the face's vertices; exactly 0 off the feature
  Vec<D> point;         ///< closest boundary point [m]
  double distance = 0;  ///< length of the path [m]
  Vec<D> normal;        ///< unit outward normal, area-weighted over the boundary faces at an edge or a vertex
};

/// Work of a search (SPB table 1). Counted only on request.
struct PathCounters {
  std::int64_t volumes_visited = 0;   ///< nodes of the hierarchy
  std::int64_t faces_visited = 0;     ///< boundary faces whose closest point was computed
  std::int64_t culled = 0;            ///< candidates dropped by infeasible-region culling
  std::int64_t traversals = 0;        ///< candidates whose segment was followed through the mesh
  std::int64_t elements_visited = 0;  ///< elements along all these segments
  std::int64_t exact_decisions = 0;   ///< predicates that needed exact arithmetic

  PathCounters& operator+=(const PathCounters& other);
};

/// Switches for measurement; none changes any answer.
struct PathOptions {
  bool cull_infeasible_regions = true;  ///< SPB section 3.6
  bool use_hints = true;                ///< start from faces near in the mesh, and from answers to other queries
};

/// Shortest paths from interior points to the boundary of a mesh that may intersect itself, in the plane and in space.
///
/// Holds the hierarchies of one mesh; positions are handed in with every new pose and copied.
/// Source: Chen, Diaz, Yuksel 2023 (SPB), section 3 and supplement, algorithms 1 to 4.
/// Thread-safe for concurrent queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include boundary_path.cpp
template <int D>
class BoundaryPathFinder {
 public:
  /// @param mesh       topology; must outlive the finder
  /// @param positions  (n_vertices x D) [m]
  /// @throws Error     when the mesh has no element, sizes differ, or a position is not finite; so do update() and
  ///                   rebuild()
  BoundaryPathFinder(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions, PathOptions options = {});
  BoundaryPathFinder(const SimplexMesh<D>&& mesh, std::span<const Vec<D>> positions, PathOptions options = {}) = delete;

  /// Stands on a locator that is asked more often than the finder, in its pose: nothing is held or computed twice.
  /// After each update() of the locator, update() without positions makes the finder ready for the new pose; until
  /// then find_paths() and find_faces_near() throw an Error. The locator's mesh must outlive the finder.
  explicit BoundaryPathFinder(PointLocator<D>& locator, PathOptions options = {});

  ~BoundaryPathFinder();
  BoundaryPathFinder(BoundaryPathFinder&&) noexcept;
  BoundaryPathFinder& operator=(BoundaryPathFinder&&) noexcept;

  /// Takes a new pose: refits the hierarchies in O(n), and rebuilds one whose quality has become poor. Parallel.
  void update(std::span<const Vec<D>> positions);

  /// Takes the pose that the locator has, at the cost of the boundary faces alone.
  void update();

  /// Takes a new pose and builds the hierarchies anew. O(n log n), parallel.
  void rebuild(std::span<const Vec<D>> positions);

  /// Elements that hold a point, and all that is known of them; always in the finder's pose, unless the finder stands
  /// on a locator of its user.
  const PointLocator<D>& locator() const;

  /// Shortest paths, one per query, in the order of the queries. Parallel; the same bits for any number of threads.
  ///
  /// For components without inverted or degenerate elements exact up to rounding in the closest point itself; with
  /// them the rules of SPB section 3.5 hold. O(log n) expected per query.
  ///
  /// @param warm_start  empty, or one boundary face per query (kNone: none) that may be near the answer, say the answer
  ///                    of the last step; never changes an answer
  /// @param counters    empty, or one per query, overwritten
  /// @throws Error      when an element is out of range, a point is not finite, or a span has the wrong size
  std::vector<BoundaryPath<D>> find_paths(std::span<const PathQuery<D>> queries, std::span<const Index> warm_start = {},
                                          std::span<PathCounters> counters = {}) const;

  /// The same for one query. Many are answered faster together.
  BoundaryPath<D> find_path(const PathQuery<D>& query, Index warm_start = kNone) const;

  /// As those of locator().
  std::vector<PathQuery<D>> find_penetrating_vertices() const { return locator().find_penetrating_vertices(); }
  LocatedPoints<D> locate(std::span<const Vec<D>> points) const { return locator().locate(points); }
  const MeshDefects& defects() const { return locator().defects(); }

  /// Boundary faces that a box may meet: all that do and a few that lie near it, in a fixed order. Parallel.
  /// @param boxes  lower and upper corner of each [m]
  NearbyItems find_faces_near(std::span<const std::array<Vec<D>, 2>> boxes) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

extern template class BoundaryPathFinder<2>;
extern template class BoundaryPathFinder<3>;

}  // namespace selvage
