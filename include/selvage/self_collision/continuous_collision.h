#pragma once

#include "selvage/self_collision/self_collision.h"

namespace selvage {

/// A vertex and a triangle that it does not belong to, which meet during a step.
struct VertexFacePair {
  Index vertex;
  Index face;

  auto operator<=>(const VertexFacePair&) const = default;
};

/// Two edges of the mesh without a common vertex, first < second, which meet during a step. The order of edges is that
/// of their (ascending) vertices.
struct EdgeEdgePair {
  Index first;
  Index second;

  auto operator<=>(const EdgeEdgePair&) const = default;
};

/// All pairs that meet during a step, each list sorted.
struct ContinuousPairs {
  std::vector<VertexFacePair> vertex_face;
  std::vector<EdgeEdgePair> edge_edge;

  bool empty() const { return vertex_face.empty() && edge_edge.empty(); }
  bool operator==(const ContinuousPairs&) const = default;
};

/// Statistics of a search, counted on request: queries are concurrent, so that each hands out its own. The same for any
/// number of threads.
struct ContinuousCounters {
  std::int64_t node_pairs = 0;         ///< pairs of nodes whose children were compared
  std::int64_t self_node_pairs = 0;    ///< those of a node with itself
  std::int64_t box_pairs = 0;          ///< pairs of triangles whose boxes over the step meet
  std::int64_t vertex_face_boxes = 0;  ///< pairs of a vertex and a face that boxes do not separate; each at most once
  std::int64_t edge_edge_boxes = 0;    ///< pairs of edges that boxes do not separate; each at most once
  std::int64_t tested_nodes = 0;       ///< nodes that culling tested
  std::int64_t culled_nodes = 0;       ///< nodes that need no comparison with themselves
  std::int64_t culled_triangles = 0;   ///< triangles in them
  std::int64_t exact_tests = 0;        ///< pairs that single precision left undecided, and that filters keep

  ContinuousCounters& operator+=(const ContinuousCounters& other);
};

/// Continuous self-collision of a surface: all pairs of a vertex and a face, and of two edges, that meet during a step
/// in which vertices move on straight lines at constant speed. Each pair once, decided exactly: no tolerance, no missed
/// pair, no invented pair.
///
/// Each vertex and each edge has one representative triangle, so that no pair is tested twice, however many pairs of
/// triangles it belongs to (low-level culling: Curtis, Tamstorf, Manocha 2008; EDC section 6.1). Vertices without a
/// triangle meet nothing.
/// Thread-safe for concurrent queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include continuous_collision.cpp
class ContinuousCollisionFinder {
 public:
  /// @param mesh          topology; must outlive the finder: a temporary is refused
  /// @param positions_t0  (n_vertices x 3) at the start of the step [m]
  /// @param positions_t1  (n_vertices x 3) at its end [m]
  /// @param options       method, filters and thickness; include_adjacent changes nothing
  /// @throws Error        when sizes differ, a position is not finite, or an option does not fit the mesh; update()
  ///                      and rebuild() likewise
  ContinuousCollisionFinder(const TriangleMesh& mesh, std::span<const Vec3> positions_t0,
                            std::span<const Vec3> positions_t1, SelfCollisionOptions options = {});
  ContinuousCollisionFinder(const TriangleMesh&&, std::span<const Vec3>, std::span<const Vec3>,
                            SelfCollisionOptions = {}) = delete;
  ~ContinuousCollisionFinder();
  ContinuousCollisionFinder(ContinuousCollisionFinder&&) noexcept;
  ContinuousCollisionFinder& operator=(ContinuousCollisionFinder&&) noexcept;

  /// Takes a new step: refits the hierarchy in O(n), and rebuilds it when its quality has become poor. Where nothing
  /// moves, bit for bit, the third such step and later ones are not searched at all, and count nothing.
  void update(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  /// Takes a new step and builds the hierarchy anew.
  void rebuild(std::span<const Vec3> positions_t0, std::span<const Vec3> positions_t1);

  /// All pairs that meet at some time of the step, its ends included; with a thickness also those that come nearer than
  /// the sum of their thickness. Parallel; the same for any number of threads.
  /// @param counters  null, or statistics to add those of this search to
  ContinuousPairs find_pairs(ContinuousCounters* counters = nullptr) const;

  /// Takes other ends for some vertices of the step, and finds the pairs with one of these vertices among all that
  /// find_pairs() would find now; pairs of other vertices are those of before. For solvers that move a few vertices
  /// and ask again: costs what is near them, and O(n) of little. Where more than a few move, update() costs as much.
  /// @param vertices      in any order
  /// @param positions_t1  (n_vertices x 3), at other vertices than these as it was [m]
  /// @throws Error        as update(), and when a vertex is out of range
  ContinuousPairs move_ends(std::span<const Index> vertices, std::span<const Vec3> positions_t1,
                            ContinuousCounters* counters = nullptr);

  /// Whether there is any pair: stops at the first.
  bool has_pairs(ContinuousCounters* counters = nullptr) const;

  /// Times of first impact, one a pair, as fractions of the step: never later than the true one, at most 1e-6 earlier,
  /// never below 0; NaN where the pair does not meet, however near it comes. Thickness does not count.
  /// @throws Error  when a vertex, a face or an edge is out of range
  std::vector<double> find_impact_times(std::span<const VertexFacePair> pairs) const;
  std::vector<double> find_impact_times(std::span<const EdgeEdgePair> pairs) const;

  /// The largest fraction of the step that is free of collisions: 1 where nothing meets; else the earliest time of
  /// impact, no later than the true one and at most 1e-6 earlier. 0 where something meets at the start.
  /// Thickness does not count: see find_separated_step().
  /// @param pairs   the pairs that find_pairs() gave, where they are known already
  /// @throws Error  when a vertex, a face or an edge is out of range
  double find_free_step() const { return find_free_step(find_pairs()); }
  double find_free_step(const ContinuousPairs& pairs) const;

  /// The largest fraction of the step during which every pair stays apart by the sum of its thickness (options): before
  /// it no pair meets, decided exactly, and none is nearer than its thickness, up to rounding in a distance. 1 where
  /// that holds for the whole step, 0 where it does not at the start. Never above find_free_step(), and equal to it
  /// without thickness.
  ///
  /// Conservative: the true fraction may be larger, see vertex_face_nearness(). The same for any number of threads.
  /// @param pairs   the pairs that find_pairs() gave, where they are known already
  /// @throws Error  when a vertex, a face or an edge is out of range
  double find_separated_step() const { return find_separated_step(find_pairs()); }
  double find_separated_step(const ContinuousPairs& pairs) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
