#pragma once

#include "peer/rounds.h"
#include "selvage/core/error.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <iostream>

namespace selvage::bench {

inline nlohmann::json to_json(const Duration& d) {
  return {{"processor", d.processor}, {"clock", d.clock}};
}

/// @param path  "-": standard output
inline void write_json_file(const std::filesystem::path& path, const nlohmann::json& json) {
  if (path == "-") {
    std::cout << json.dump(1) << '\n';
    return;
  }
  std::ofstream file(path);
  file << json.dump(1) << '\n';
  if (!file.flush()) throw Error(path.string(), "cannot be written", "give a folder that exists");
}

}  // namespace selvage::bench
