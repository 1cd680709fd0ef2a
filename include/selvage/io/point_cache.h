#pragma once

#include "selvage/core/types.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace selvage {

/// Positions of the same vertices, sample by sample: a .pc2, the point cache of 3ds Max and Blender. It has no
/// triangles; those are in a mesh file beside it.
struct PointCache {
  double first_frame = 0;                  ///< number of the frame of the first sample
  double frames_per_sample = 1;            ///< from one sample to the next; above 0
  std::vector<std::vector<Vec3>> samples;  ///< each (n_vertices), as many in all [m]; at least one
};

/// @param name  of the file, for errors
/// @throws Error  when the header is none of a .pc2, counts are impossible, or the bytes are fewer or more than those
///                counts say; or a position is not finite. One line with the place
PointCache parse_point_cache(std::string_view bytes, const std::string& name);

/// @throws Error  as parse_point_cache(), or when the file cannot be read
PointCache read_point_cache(const std::filesystem::path& path);

/// The bytes of a .pc2, which holds floats.
/// @param cache  samples of as many vertices each, whose coordinates floats can hold
std::string print_point_cache(const PointCache& cache);

}  // namespace selvage
