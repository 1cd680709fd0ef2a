#pragma once

#include "selvage/scene/scene.h"

namespace selvage {

/// The parts of a scene that its frames do not hold, as the JSON of scene.json in a run's folder: names and materials
/// of bodies, colliders with their motions, settings of the solver (docs/guides/run_files.md).
std::string print_scene(const Scene& scene);

}  // namespace selvage
