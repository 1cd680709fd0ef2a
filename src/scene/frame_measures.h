#pragma once

#include "selvage/boundary_path/boundary_path.h"
#include "selvage/scene/run.h"
#include "simulation/crossings/body_crossings.h"
#include "simulation/crossings/collider_crossings.h"
#include "simulation/implicit/energies.h"

namespace selvage {

/// Measures states of a scene, one after the other.
class FrameMeasures {
 public:
  /// @param scene  must outlive the measures
  explicit FrameMeasures(const Scene& scene);

  /// Sets all of a row that is measured at the end of a frame, and crossings().
  void measure(const State& state, std::int64_t frame, FrameStatistics& row);

  /// Of the state measured last.
  const Crossings& crossings() const { return crossings_; }

  /// The first body without volume in that state, or null.
  const Body* find_body_without_volume() const;

  /// Positions to store in a frame, of the state measured last: as they are with a guarantee, else floats.
  std::vector<Vec3> stored_positions(const State& state);

 private:
  const Scene& scene_;
  EnergyMeasure energies_;
  BoundaryPathFinder<3> finder_;
  BodyCrossingFinder bodies_;
  ColliderCrossingFinder colliders_;
  SolidMeasure solids_;
  Crossings crossings_;
};

}  // namespace selvage
