#pragma once

#include "selvage/self_collision/continuous_collision.h"

namespace selvage {

/// A vertex and a triangle that it does not belong to, nearer to each other than a given distance.
struct NearVertexFace {
  Index vertex = kNone;
  Index face = kNone;
  double distance = 0;                  ///< exactly 0 where they meet, and only there [m]
  std::array<double, 3> barycentric{};  ///< of the nearest point of the face in its vertices
  std::array<Vec3, 2> nearest{};        ///< points of the vertex and of the face that are nearest to each other [m]
};

/// Two edges without a common vertex, first < second, nearer to each other than a given distance.
struct NearEdges {
  Index first = kNone;
  Index second = kNone;
  double distance = 0;            ///< exactly 0 where they meet, and only there [m]
  std::array<double, 2> place{};  ///< of each nearest point along its edge: 0 at the smaller vertex, 1 at the other
  std::array<Vec3, 2> nearest{};  ///< points of the two edges that are nearest to each other [m]
};

/// All pairs nearer than a given distance, each list sorted by the numbers of the pairs.
struct NearPairs {
  std::vector<NearVertexFace> vertex_face;
  std::vector<NearEdges> edge_edge;

  bool empty() const { return vertex_face.empty() && edge_edge.empty(); }
};

/// Pairs of a surface within a distance of each other in one pose: vertices and faces, edges and edges, without a
/// common vertex; each pair once, with its distance and nearest points. For barriers, repulsions and thick cloth.
///
/// Any surface is legal, see SelfCollisionFinder. Vertices without a triangle are near nothing. No pair is missed;
/// distances are computed in doubles, see closest_point_on_triangle() and closest_points().
/// Thread-safe for concurrent queries; update() and rebuild() need exclusive access.
///
/// Example, built and run by the tests:
/// @include proximity.cpp
class ProximityFinder {
 public:
  /// @param mesh       topology; must outlive the finder: a temporary is refused
  /// @param positions  (n_vertices x 3) [m]
  /// @param distance   pairs count that are nearer; positive [m]
  /// @param on_progress  as SelfCollisionOptions::on_progress, for the search of find_pairs()
  /// @throws Error     when sizes differ, a position is not finite, the distance is not positive and finite, or a
  ///                   filter does not fit the mesh; update() and rebuild() likewise
  ProximityFinder(const TriangleMesh& mesh, std::span<const Vec3> positions, double distance, PairFilters filters = {},
                  std::function<void(double share)> on_progress = {});
  ProximityFinder(const TriangleMesh&&, std::span<const Vec3>, double, PairFilters = {},
                  std::function<void(double share)> = {}) = delete;
  ~ProximityFinder();
  ProximityFinder(ProximityFinder&&) noexcept;
  ProximityFinder& operator=(ProximityFinder&&) noexcept;

  /// Takes a new pose. Refits the hierarchy in O(n), and rebuilds it when its quality has become poor. Where poses
  /// follow one another by little, as in a simulation, lists all pairs that come near while vertices move on as they
  /// do, for ten poses or so: then these cost a search for what moves otherwise, and find_pairs() only measures the
  /// list. The pairs are the same.
  void update(std::span<const Vec3> positions);

  /// Takes a new pose and builds the hierarchy anew.
  void rebuild(std::span<const Vec3> positions);

  /// All pairs nearer than the distance. O(n log n + pairs) expected; parallel; the same bits for any number of
  /// threads.
  /// @param counters  null, or statistics to add those of this search to
  NearPairs find_pairs(ContinuousCounters* counters = nullptr) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace selvage
