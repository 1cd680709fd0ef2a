#pragma once

#include "selvage/core/types.h"

#include <optional>

namespace selvage {

/// A rectangle of the picture [pixels], y downward.
struct Frame {
  double left = 0, top = 0, right = 0, bottom = 0;
};

/// Where a camera looks from. Without an eye it stands as near as it can while all is seen.
struct View {
  std::optional<Vec3> towards{};  ///< direction from what is seen to the eye, of any length but 0
  std::optional<Vec3> eye{};      ///< [m] its place
  std::optional<Vec3> target{};   ///< [m] with an eye: the point in the middle of the picture
  double angle = 30;              ///< with an eye: between the lowest and the highest ray [degrees]
  Vec3 up = Vec3::UnitZ();        ///< the direction that is shown upwards
};

/// Perspective camera with the y axis of the screen downward.
class Camera {
 public:
  /// @param points  what must be seen, or with an eye what sizes are relative to; at least one
  /// @param view    without a direction or an eye they are seen from the side where they spread most, a little from
  ///                above
  /// @param frame   where on the picture they shall be
  Camera(std::span<const Vec3> points, const View& view, const Frame& frame);

  /// Place on the picture (x, y) [pixels] and distance from the eye along the line of sight [m].
  Vec3 project(const Vec3& p) const { return project_turned(rotate(p - eye_)); }

  /// The same for a point that is given in the axes of the camera, from the eye.
  Vec3 project_turned(const Vec3& d) const {
    return {centre_x_ + focal_ * d[0] / d[2], centre_y_ + focal_ * d[1] / d[2], d[2]};
  }

  /// Direction `d` in the axes of the camera: right, down, away from the eye.
  Vec3 rotate(const Vec3& d) const { return {right_.dot(d), down_.dot(d), forward_.dot(d)}; }

  /// Reverses rotate().
  Vec3 rotate_back(const Vec3& d) const { return d[0] * right_ + d[1] * down_ + d[2] * forward_; }

  /// Way from the eye to what is seen at a place of the picture [pixels], for each metre along the line of sight.
  Vec3 ray(double x, double y) const { return rotate_back({(x - centre_x_) / focal_, (y - centre_y_) / focal_, 1}); }

  const Vec3& eye() const { return eye_; }

  /// Pixels that a length of one metre takes at that distance from the eye.
  double pixels_per_metre(double distance) const { return focal_ / distance; }

  /// Radius of the ball around the points, for sizes relative to what is shown [m].
  double scene_radius() const { return radius_; }

 private:
  void choose_axes(std::span<const Vec3> points, const View& view);
  void fit(std::span<const Vec3> points, const Frame& frame);

  Vec3 right_, down_, forward_, eye_;
  double focal_ = 1, radius_ = 1;
  double centre_x_ = 0, centre_y_ = 0;
};

}  // namespace selvage
