#pragma once

#include "selvage/core/types.h"

#include <optional>

namespace selvage {

/// A rectangle of the picture [pixels], y downward.
struct Frame {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// Perspective camera with the y axis of the screen downward.
class Camera {
 public:
  /// A camera that shows all points as large as the frame allows.
  ///
  /// @param points   what must be seen; at least one
  /// @param towards  direction from the points to the eye; without it they are seen from the side where they spread
  ///                 most, a little from above
  /// @param frame    where on the picture they shall be
  Camera(std::span<const Vec3> points, const std::optional<Vec3>& towards, const Frame& frame);

  /// Place on the picture (x, y) [pixels] and distance from the eye along the line of sight [m].
  Vec3 project(const Vec3& p) const;

  /// Direction `d` in the axes of the camera: right, down, away from the eye.
  Vec3 rotate(const Vec3& d) const;

  /// Pixels that a length of one metre takes at that distance from the eye.
  double pixels_per_metre(double distance) const { return focal_ / distance; }

  /// Radius of the ball around the points, for sizes relative to what is shown [m].
  double scene_radius() const { return radius_; }

 private:
  void choose_axes(std::span<const Vec3> points, const std::optional<Vec3>& towards);

  Vec3 right_, down_, forward_, query_point_;
  double focal_ = 1, radius_ = 1;
  double centre_x_ = 0, centre_y_ = 0;
};

}  // namespace selvage
