#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace selvage {

struct RunPageOptions {
  std::int64_t every = 1;  ///< show each frame whose number is a multiple of this, and the last
  /// Find contacts, and in frames whose statistics count some, points inside and triangles that cross.
  bool marks = true;
  std::vector<std::array<std::string, 3>> facts{};          ///< more lines for the table: group, name, value
  std::function<void(double share)> on_progress = nullptr;  ///< with the share that is done, or null
};

/// The page of a run's folder, up to its last whole frame.
///
/// @throws Error  when the folder holds no run, a file in it is missing or damaged or of another run, or the page would
///                be longer than browsers open
std::string print_run_page(const std::filesystem::path& folder, const RunPageOptions& options = {});

}  // namespace selvage
