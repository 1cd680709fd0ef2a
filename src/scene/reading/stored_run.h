#pragma once

#include "selvage/scene/frames.h"
#include "selvage/scene/run.h"

#include <nlohmann/json.hpp>

namespace selvage {

/// A run's folder, up to its last whole frame: the files that all frames share, checked against each other.
struct StoredRun {
  std::filesystem::path folder;
  TopologyFile topology;
  std::int64_t last_frame = 0;
  std::vector<FrameStatistics> rows;      ///< of frames 0 to last_frame
  nlohmann::ordered_json scene, summary;  ///< null where the folder has none

  /// @throws Error  when the folder holds no run, or a file in it is missing or damaged
  explicit StoredRun(const std::filesystem::path& path);

  /// Positions that a frame, or the file of the shape at rest, holds [m].
  /// @throws Error  when the file is missing, damaged or of another run, or a position is not finite
  std::vector<Vec3> read_positions(const std::filesystem::path& path) const;
  std::vector<Vec3> read_frame_positions(std::int64_t frame) const { return read_positions(frame_path(folder, frame)); }

  /// Name of the scene, or where it is not known, of the folder.
  std::string name() const;

  /// Frames whose number is a multiple of `every`, and the last.
  std::vector<std::int64_t> frames(std::int64_t every) const;
};

}  // namespace selvage
