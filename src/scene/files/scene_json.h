#pragma once

#include "selvage/scene/scene.h"

namespace selvage {

/// The parts of a scene that its frames do not hold, as the JSON of scene.json in a run's folder: names and materials
/// of bodies, colliders with their motions, settings of the solver (docs/guides/run_files.md).
/// The key frames of a collider that changes its form are in a file beside it: see keyframes_name().
std::string print_scene(const Scene& scene);

/// Name of the point cache with the key frames of a collider.
std::string keyframes_name(std::size_t collider);

}  // namespace selvage
