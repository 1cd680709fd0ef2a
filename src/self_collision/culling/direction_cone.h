#pragma once

#include "selvage/core/types.h"

namespace selvage {

/// All directions within an angle of an axis, as the papers on cones bound normals and binormals. Its rounding is not
/// bounded: what must be certain is decided elsewhere.
struct DirectionCone {
  Vec3 axis = Vec3::Zero();
  double angle = -1;  ///< half of the apex angle [rad]; negative: no direction at all; pi: all of them

  static DirectionCone of(const Vec3& direction);
  bool is_empty() const { return angle < 0; }

  /// Takes in another cone: its axis becomes the middle of both (Provot 1997).
  void merge(const DirectionCone& other);
};

}  // namespace selvage
