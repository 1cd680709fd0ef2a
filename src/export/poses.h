#pragma once

#include "scene/reading/shown_surface.h"

#include <array>
#include <functional>
#include <string>

namespace selvage {

using Float3 = std::array<float, 3>;

/// Poses of a surface that a format is made of.
struct ExportedPoses {
  std::string name;  ///< of the scene
  const ShownSurface& surface;
  std::vector<std::int64_t> frames;
  int frames_per_second = 60;
  /// Positions of the surface's vertices in frame `frames[i]`, as the file of the frame has them [m].
  std::function<std::vector<Float3>(std::size_t i)> pose;
};

std::string print_pc2(const ExportedPoses& poses);
/// The mesh that a .pc2 moves, in its first pose.
std::string print_pc2_mesh(const ExportedPoses& poses);
std::string print_glb(const ExportedPoses& poses);
std::string print_usda(const ExportedPoses& poses);

}  // namespace selvage
