#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/simulation/collider.h"
#include "selvage/simulation/crossings.h"
#include "selvage/simulation/model.h"
#include "simulation/crossings/collider_curves.h"

namespace selvage {

struct PreparedCollider;

/// Measures how far bodies and colliders stand in one another, in any pose and whatever led to it.
///
/// Vertices are measured exactly. The collider's own points are its corners, points of its edges and of its round sides
/// (find_features()) at most a quarter of a cell apart, and points of its faces at most a cell apart: what reaches into
/// a body between two of them by more than they say is smaller than that. Vertices that a handle holds, and elements
/// held by all four, are left out: nothing but their handles moves them.
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
  std::vector<ColliderCrossings> measure(const BoundaryPathFinder<3>& finder, const State& state);
  /// The same with a finder of its own, which it makes only where a collider is near a body.
  std::vector<ColliderCrossings> measure(const State& state);

 private:
  struct Pose;
  struct Sample;
  template <typename MakeFinder>
  std::vector<ColliderCrossings> measure_with(const State& state, MakeFinder&& make_finder);
  void place_keyframed(double time);
  void measure_vertices(std::size_t collider, std::size_t body, const Pose& pose, ColliderCrossings& result) const;
  void sample_points(std::size_t collider, std::size_t body, const Pose& pose, std::vector<Sample>& samples) const;
  void measure_points(const BoundaryPathFinder<3>& finder, const Pose& pose, std::span<const Sample> samples,
                      std::vector<ColliderCrossings>& results) const;

  const Model* model_;
  std::span<const Collider> colliders_;
  std::span<const Handle> handles_;
  std::vector<std::vector<PreparedCollider>> parts_;  ///< of each collider
  std::vector<ColliderFeatures> mesh_features_;       ///< of each collider that is a mesh, key-framed or not
  std::vector<double> cells_;                         ///< of the bodies [m]
};

}  // namespace selvage
