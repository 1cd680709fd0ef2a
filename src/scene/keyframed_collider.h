#pragma once

#include "scene/description/scene_description.h"

namespace selvage {

/// Reads the key frames of a collider.
///
/// @param frames_per_second  of the scene
/// @throws Error  one line with the place in the scene and the file: a file that cannot be read, a surface that is not
///                closed, a key frame with other vertices or triangles than the first, a point cache for another mesh
KeyframedShape read_keyframed_shape(const KeyframeSource& source, const Placement& place, double frames_per_second);

}  // namespace selvage
