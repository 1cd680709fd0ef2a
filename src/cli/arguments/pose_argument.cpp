#include "cli/arguments/pose_argument.h"

#include "cli/arguments/numbers.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

namespace selvage::cli {

namespace {

template <typename T>
T number_of(std::string_view key, std::string_view value) {
  const auto number = read_number<T>(value);
  if (!number) throw Error("--pose", fmt::format("'{}' is not a value for {}", value, key), "give a number");
  return *number;
}

int axis_of(std::string_view value) {
  for (const std::string_view names : {"xyz", "012"}) {
    if (value.size() == 1 && names.find(value) != std::string_view::npos) return static_cast<int>(names.find(value));
  }
  throw Error("--pose", fmt::format("'{}' is not an axis", value), "use x, y or z");
}

void set_option(PoseOptions& options, std::string_view key, std::string_view value) {
  if (key == "axis") {
    options.axis = axis_of(value);
  } else if (key == "turns") {
    options.turns = number_of<double>(key, value);
  } else if (key == "angle") {
    options.angle = number_of<double>(key, value);
  } else if (key == "crossings") {
    options.crossings = number_of<int>(key, value);
  } else if (key == "core") {
    options.core = number_of<double>(key, value);
  } else if (key == "dx" || key == "dy" || key == "dz") {
    if (!options.offset) options.offset = Vec3::Zero();
    (*options.offset)[key[1] - 'x'] = number_of<double>(key, value);
  } else {
    throw Error("--pose", fmt::format("there is no option '{}'", key),
                "use axis, turns, angle, crossings, core, dx, dy or dz");
  }
}

}  // namespace

PoseArgument parse_pose(std::string_view text) {
  PoseArgument pose;
  std::size_t end = std::min(text.find(','), text.size());
  pose.name = text.substr(0, end);
  while (end < text.size()) {
    text.remove_prefix(end + 1);
    end = std::min(text.find(','), text.size());
    const std::string_view item = text.substr(0, end);
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) {
      throw Error("--pose", fmt::format("'{}' is not an option", item), "write KEY=VALUE, as in bend,axis=x,turns=1.5");
    }
    set_option(pose.options, item.substr(0, equals), item.substr(equals + 1));
  }
  return pose;
}

}  // namespace selvage::cli
