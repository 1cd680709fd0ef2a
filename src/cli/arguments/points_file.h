#pragma once

#include "selvage/core/types.h"

#include <filesystem>

namespace selvage::cli {

/// A point whose way out is asked for; the element is kNone where the file names none.
struct AskedPoint {
  Vec3 point;
  Index element = kNone;
  int line = 0;  ///< of the file, from 1
};

/// Reads a points file: one `x,y,z` or `x,y,z,element` a line. A header line, empty lines and lines that begin with '#'
/// are passed over.
///
/// @param element_count  elements must lie in [0, element_count)
/// @throws Error         names file and line: too few or too many numbers, none or not finite, an element out of range
std::vector<AskedPoint> read_points(const std::filesystem::path& path, Index element_count);

}  // namespace selvage::cli
