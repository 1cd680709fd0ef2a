#pragma once

#include "selvage/shapes/poses.h"

#include <string>
#include <string_view>

namespace selvage::cli {

/// A pose as it is written on the command line: its name, and options after commas, as in `bend,axis=x,turns=1.5`.
struct PoseArgument {
  std::string name;
  PoseOptions options;
};

/// Reads `NAME[,KEY=VALUE]...`; keys are axis (x, y, z), turns, angle [rad], crossings, core, and dx, dy, dz for an
/// offset.
/// @throws Error  for an unknown key or a value that is not a number; the name is judged by apply_pose()
PoseArgument parse_pose(std::string_view text);

}  // namespace selvage::cli
