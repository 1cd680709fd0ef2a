#pragma once

#include "picture/drawing/camera.h"

#include <vector>

namespace selvage {

/// Where the camera is in one frame.
struct CameraKey {
  double frame = 0;
  View view{};  ///< with eye and target
};

/// The view between the keys around a frame: eye, target and angle move along straight lines, and rest before the first
/// and after the last.
/// @param keys  at least one, ascending in frame
View view_at(std::span<const CameraKey> keys, double frame);

}  // namespace selvage
