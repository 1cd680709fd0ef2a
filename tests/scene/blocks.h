#pragma once

#include "selvage/scene/run.h"
#include "temporary_folder.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace selvage::blocks {

/// Two blocks that fall on a floor and on one another, one of them held and let go.
inline std::string falling_blocks(const std::string& changes = "") {
  return R"({"selvage_scene": 1, "frames": 6, "substeps": 3, "iterations": 2,
    "bodies": [
      {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.34}, "material": {"youngs_modulus": 2e4},
       "translate": [0, 0, 0.02], "velocity": [0, 0, -1]},
      {"mesh": {"shape": "box", "size": [1, 1, 1], "cell": 0.34}, "translate": [0.3, 0.2, 1.05], "velocity": [0, 0, -2],
       "handles": [{"region": {"box": {"min": [-1, -1, 0.9], "max": [2, 2, 2]}}, "release": 0.05,
                    "motion": {"keyframes": [{"time": 0}, {"time": 1, "translate": [0, 0, -1]}]}}]}],
    "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}])" +
         changes + "}";
}

inline Scene scene_of(const std::string& text) {
  return parse_scene(text, "blocks.json");
}

inline RunOptions to(const std::filesystem::path& folder) {
  RunOptions options;
  options.folder = folder;
  return options;
}

/// All files of a run by name, without what it cost.
inline std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string name = std::filesystem::relative(entry.path(), folder).string();
    if (!entry.is_regular_file() || name == "summary.json") continue;
    std::string bytes = test::read_text(entry.path());
    if (name == "statistics.csv") {
      std::string costless;
      for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
        std::string line = bytes.substr(at, end - at);
        for (int cost = 0; cost < 11; ++cost) line.resize(line.rfind(','));
        costless += line + "\n";
        at = end + 1;
      }
      bytes = costless;
    }
    files[name] = bytes;
  }
  return files;
}

/// Names of the files in which two runs differ.
inline std::vector<std::string> differences(const std::map<std::string, std::string>& a,
                                            const std::map<std::string, std::string>& b) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : a)
    if (b.count(name) == 0 || b.at(name) != bytes) names.push_back(name);
  for (const auto& [name, bytes] : b)
    if (a.count(name) == 0) names.push_back(name);
  return names;
}

}  // namespace selvage::blocks
