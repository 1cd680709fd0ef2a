#pragma once

#include "selvage/core/types.h"
#include "selvage/mesh/simplex_mesh.h"

#include <memory>

namespace selvage {

/// What became of a query.
enum class PathStatus : std::uint8_t {
  kFound,         ///< the shortest path is given
  kNoPath,        ///< every candidate is blocked, or none is left
  kNotInElement,  ///< the point does not lie in the element it was said to be in, or the element is exactly flat
};

/// Where on the boundary face the closest boundary point lies.
enum class BoundaryFeature : std::uint8_t { kFace, kEdge, kVertex };

/// An interior point whose way out is asked for.
template <int D>
struct PathQuery {
  Vec<D> point;   ///< [m]
  Index element;  ///< the element that the point is taken to be in: one place may hold several material points
  /// Vertices that span the boundary simplex on which the point lies, when it is a boundary point that has penetrated:
  /// a vertex (v, kNone) or an edge (a, b). The boundary faces that have all of them are no candidates.
  std::array<Index, 2> source{kNone, kNone};
};

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

/// What a search did (SPB table 1). Counted only on request.
struct PathCounters {
  std::int64_t volumes_visited = 0;   ///< nodes of the hierarchy
  std::int64_t faces_visited = 0;     ///< boundary faces whose closest point was computed
  std::int64_t culled = 0;            ///< candidates dropped by infeasible-region culling
  std::int64_t traversals = 0;        ///< candidates whose segment was followed through the mesh
  std::int64_t elements_visited = 0;  ///< elements along all these segments
  std::int64_t exact_decisions = 0;   ///< predicates that needed exact arithmetic

  PathCounters& operator+=(const PathCounters& other);
};

/// What is wrong with a pose: where the theorems of SPB do not hold.
struct MeshDefects {
  std::int64_t inverted_elements = 0;
  std::int64_t degenerate_elements = 0;
  /// Interior ridges (edges in 3D, vertices in 2D) around which the elements turn twice or more (angles sum to 4 pi).
  std::int64_t overwound_interior_ridges = 0;
  /// Boundary ridges around which the elements turn by more than 2 pi.
  std::int64_t overwound_boundary_ridges = 0;
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
template <int D>
class BoundaryPathFinder {
 public:
  /// @param mesh       topology; must outlive the finder
  /// @param positions  (n_vertices x D) [m]
  /// @throws Error     when the mesh has no element, sizes differ, or a position is not finite; so do update() and
  ///                   rebuild()
  BoundaryPathFinder(const SimplexMesh<D>& mesh, std::span<const Vec<D>> positions, PathOptions options = {});
  ~BoundaryPathFinder();
  BoundaryPathFinder(BoundaryPathFinder&&) noexcept;
  BoundaryPathFinder& operator=(BoundaryPathFinder&&) noexcept;

  /// Takes a new pose: refits the hierarchies in O(n), and rebuilds one whose quality has become poor.
  void update(std::span<const Vec<D>> positions);

  /// The same in two halves, for poses in which next to nothing is asked of the boundary: until the second is called,
  /// find_paths() and find_faces_near() throw, and all else may be asked.
  void update_elements(std::span<const Vec<D>> positions);
  void update_faces();

  /// Takes a new pose and builds the hierarchies anew.
  void rebuild(std::span<const Vec<D>> positions);

  /// Defects of the current pose.
  const MeshDefects& defects() const;

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

  /// Vertex-element DCD: every pair of a boundary vertex and an element that holds it (closed, decided exactly) but
  /// does not have it as a vertex, ready for find_paths(); ordered by vertex, then element. Inverted elements on the
  /// boundary are skipped (SPB section 3.5), flat ones hold nothing. Parallel.
  std::vector<PathQuery<D>> find_penetrating_vertices() const;

  /// Elements that hold each point (closed, decided exactly): for each point a query per element, ascending; `first`
  /// has n_points + 1 entries and gives each point's share of `queries`. Flat elements hold nothing.
  struct Located {
    std::vector<PathQuery<D>> queries;
    std::vector<std::int64_t> first;
  };
  /// @throws Error  when a point is not finite
  Located locate(std::span<const Vec<D>> points) const;

  /// The same for vertices, on the boundary or not, each without its own elements: all pairs ascending by vertex, then
  /// element, ready for find_paths().
  /// @throws Error  when a vertex is out of range
  std::vector<PathQuery<D>> locate_vertices(std::span<const Index> vertices) const;

  /// Elements, or boundary faces, that a box may meet: all that do and a few that lie near it, in a fixed order;
  /// `first` has n_boxes + 1 entries and gives each box's share. Boxes are given by their lower and upper corner.
  /// Parallel.
  struct Nearby {
    std::vector<Index> found;
    std::vector<std::int64_t> first;
  };
  Nearby find_elements_near(std::span<const std::array<Vec<D>, 2>> boxes) const;
  Nearby find_faces_near(std::span<const std::array<Vec<D>, 2>> boxes) const;

  /// Elements of the current pose that are inverted or flat, ascending.
  std::span<const Index> defective_elements() const;

  /// (n_vertices) 1 where the elements around the vertex are proven to overlap nowhere but at common points, provided
  /// that none of them is defective; 0 elsewhere.
  std::span<const std::uint8_t> locally_injective_vertices() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

extern template class BoundaryPathFinder<2>;
extern template class BoundaryPathFinder<3>;

}  // namespace selvage
