#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/simulation/collider.h"
#include "selvage/simulation/model.h"
#include "simulation/crossings/collider_curves.h"

namespace selvage {

struct PreparedCollider;

/// How far bodies and one collider stand in one another.
///
/// Counted are depths of more than kMinCrossing of the body's cell, the mean length of its elements' edges at rest.
/// The deepest are the deepest of all, 0 where there are none.
struct ColliderCrossings {
  std::int64_t vertices = 0;    ///< of bodies, inside the collider
  double deepest_vertex = 0;    ///< of them, by its shortest way out of the collider [m]
  std::int64_t points = 0;      ///< of the collider, inside elements
  double deepest_point = 0;     ///< of them, by its shortest path to the boundary [m]
  double deepest_in_cells = 0;  ///< the largest of these depths over the cell of its body

  bool any() const { return vertices > 0 || points > 0; }
  void add(const ColliderCrossings& other);
};

/// Part of a body's cell up to which a depth counts as contact.
inline constexpr double kMinCrossing = 0.01;

/// Measures how far bodies and colliders stand in one another, in any pose and whatever led to it.
///
/// Vertices are measured exactly. The collider's own points are its corners, and points of its edges and of its round
/// sides (find_features()) at most a quarter of a cell apart: what reaches into a body between two of them by more than
/// they say is smaller than that. Vertices that a handle holds, and elements held by all four, are left out: nothing
/// but their handles moves them.
class ColliderCrossingFinder {
 public:
  /// @param model   must outlive the finder, as must colliders and handles
  /// @throws Error  when a collider is impossible
  ColliderCrossingFinder(const Model& model, std::span<const Collider> colliders, std::span<const Handle> handles = {});
  ~ColliderCrossingFinder();
  ColliderCrossingFinder(ColliderCrossingFinder&&) noexcept;
  ColliderCrossingFinder& operator=(ColliderCrossingFinder&&) noexcept;

  /// One answer a collider.
  /// @param finder  of the model's mesh, in the state's pose
  std::vector<ColliderCrossings> measure(const BoundaryPathFinder<3>& finder, const State& state) const;

 private:
  struct Pose;
  struct Sample;
  void measure_vertices(std::size_t collider, std::size_t body, const Pose& pose, ColliderCrossings& result) const;
  void sample_points(std::size_t collider, std::size_t body, const Pose& pose, std::vector<Sample>& samples) const;
  void measure_points(const BoundaryPathFinder<3>& finder, const Pose& pose, std::span<const Sample> samples,
                      std::vector<ColliderCrossings>& results) const;

  const Model* model_;
  std::span<const Collider> colliders_;
  std::span<const Handle> handles_;
  std::vector<std::vector<PreparedCollider>> parts_;  ///< of each collider
  std::vector<ColliderFeatures> mesh_features_;       ///< of each collider that is a mesh
  std::vector<double> cells_;                         ///< of the bodies [m]
};

}  // namespace selvage
