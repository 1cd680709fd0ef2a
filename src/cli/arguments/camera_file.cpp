#include "cli/arguments/camera_file.h"

#include "cli/arguments/numbers.h"
#include "cli/arguments/picture_options.h"
#include "io/whole_file.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace selvage::cli {

namespace {

View read_view(std::string_view text, const std::string& place, const Vec3& up) {
  constexpr const char* kRemedy =
      "write frame,X,Y,Z,X,Y,Z: the eye and what it looks at, and after them the angle if wanted";
  try {
    View view = read_camera(text, up);
    if (!view.eye) throw Error(place, "names no eye and target", kRemedy);
    view.up = up;
    return view;
  } catch (const Error&) {
    throw Error(place, fmt::format("'{}' is no eye and target", text), kRemedy);
  }
}

}  // namespace

std::vector<CameraKey> read_camera_file(const std::filesystem::path& path, const Vec3& up) {
  const std::string text = read_whole_file(path);
  std::vector<CameraKey> keys;
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = trim(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty() || line[0] == '#') continue;
    const std::size_t comma = std::min(line.find(','), line.size());
    const std::string place = fmt::format("{}, line {}", path.string(), number);
    const auto frame = read_number<double>(trim(line.substr(0, comma)));
    if (!frame && number == 1) continue;
    if (!frame || !std::isfinite(*frame))
      throw Error(place, fmt::format("'{}' is no number of a frame", trim(line.substr(0, comma))));
    if (!keys.empty() && *frame <= keys.back().frame)
      throw Error(place, fmt::format("frame {} does not come after {}", *frame, keys.back().frame), "sort the lines");
    keys.push_back({*frame, read_view(line.substr(std::min(comma + 1, line.size())), place, up)});
  }
  if (keys.empty()) throw Error(path.string(), "has no line with a camera", "write frame,X,Y,Z,X,Y,Z");
  return keys;
}

}  // namespace selvage::cli
