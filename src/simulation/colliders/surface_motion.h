#pragma once

#include "simulation/colliders/mesh_collider.h"

#include <memory>

namespace selvage {

/// The key frames of a collider, and its surface at the start of a step.
class SurfaceMotion {
 public:
  /// @param at_first  the surface at the first key frame
  /// @throws Error  when times do not ascend, or a key frame has another number of vertices, is not finite, or faces
  ///                inwards as a whole; it names `where`
  SurfaceMotion(const std::string& where, const KeyframedShape& shape, const MeshCollider& at_first);

  /// Begins a step: this is the surface at its start, `end` that at its end. Where the step before ended at this start,
  /// its surface is taken over.
  void set_step(double start_time, double end_time, MeshCollider& end);

  /// Where a point comes to that moves with the surface from the start of the step to its end: what is nearest to it
  /// moves it along and turns it. A point of the surface stays on it.
  Vec3 carry(const Vec3& p, const MeshCollider& end) const;

  bool is_still() const { return is_still_; }
  const MeshCollider& start() const { return start_; }
  /// Of the surface at both ends of the step.
  Eigen::AlignedBox3d bounds(const MeshCollider& end) const { return start_.bounds().merged(end.bounds()); }

 private:
  KeyframedShape shape_;
  MeshCollider start_;
  double start_time_, end_time_;  ///< [s] of the step
  bool is_still_ = true;
};

/// Where a key-framed surface meets what lies between the vertices of bodies: its vertices, moved a little inward.
std::vector<Vec3> inset_positions(const MeshCollider& mesh, double inset);

}  // namespace selvage
