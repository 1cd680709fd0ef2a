#pragma once

#include "picture/scene_picture.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace selvage::cli {

/// A camera: the name of a side (corner, front, back, left, right, top, bottom), `X,Y,Z` (a direction from what is seen
/// to the eye), `X,Y,Z,X,Y,Z` (the eye and the point in the middle of the picture) or, with a seventh number, the
/// angle between the lowest and the highest ray [degrees].
/// @param up  the direction that is shown upwards; sides are named for z upwards, and turned with it
/// @throws Error  when it is none of these
View read_camera(std::string_view text, const Vec3& up);

/// A cut: `x:0.5`, the axis that it lies across and its place there [m].
AxisCut read_cut(std::string_view text);

/// Frames: numbers, `last`, and ranges FIRST:LAST or FIRST:LAST:STEP whose ends may be left out, joined by commas.
/// @throws Error  when it is none of these, or a frame is not among 0 to last_frame
std::vector<std::int64_t> read_frames(std::string_view text, std::int64_t last_frame);

}  // namespace selvage::cli
