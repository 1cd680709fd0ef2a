#include "cli/arguments/picture_options.h"

#include "cli/arguments/numbers.h"
#include "selvage/core/error.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace selvage::cli {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = std::min(text.find(separator), text.size());
    parts.push_back(trim(text.substr(0, end)));
    if (end == text.size()) return parts;
    text.remove_prefix(end + 1);
  }
}

struct NamedSide {
  std::string_view name;
  double x, y, z;
};

constexpr std::array<NamedSide, 7> kSides{{{"corner", 0.5, -1, 0.5},
                                           {"front", 0, -1, 0},
                                           {"back", 0, 1, 0},
                                           {"left", -1, 0, 0},
                                           {"right", 1, 0, 0},
                                           {"top", 0, 0, 1},
                                           {"bottom", 0, 0, -1}}};

[[noreturn]] void refuse_camera(std::string_view text) {
  throw Error("--camera", fmt::format("'{}' is no camera", text),
              "give corner, front, back, left, right, top or bottom, or X,Y,Z, the direction to the eye, or "
              "X,Y,Z,X,Y,Z, the eye and what it looks at");
}

std::int64_t read_frame(std::string_view text, std::string_view whole, std::int64_t last_frame) {
  if (text == "last") return last_frame;
  const auto frame = read_number<std::int64_t>(text);
  if (!frame)
    throw Error("--frames", fmt::format("'{}' is no list of frames", whole), "give 12, last, 0,60,last or 0:last:10");
  if (*frame < 0 || *frame > last_frame)
    throw Error("--frames", fmt::format("there is no frame {}", *frame),
                fmt::format("frames are numbered from 0 to {}", last_frame));
  return *frame;
}

}  // namespace

View read_camera(std::string_view text, const Vec3& up) {
  View view;
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), up);
  for (const NamedSide& side : kSides) {
    if (side.name != text) continue;
    view.towards = turn * Vec3(side.x, side.y, side.z);
    return view;
  }
  std::vector<double> numbers;
  for (const std::string_view part : split(text, ',')) {
    const auto number = read_number<double>(part);
    if (!number || !std::isfinite(*number)) refuse_camera(text);
    numbers.push_back(*number);
  }
  if (numbers.size() == 3) {
    const Vec3 towards(numbers[0], numbers[1], numbers[2]);
    const double largest = towards.cwiseAbs().maxCoeff();
    if (largest == 0) refuse_camera(text);
    view.towards = (towards / largest).normalized();
    return view;
  }
  if (numbers.size() != 6 && numbers.size() != 7) refuse_camera(text);
  view.eye = Vec3(numbers[0], numbers[1], numbers[2]);
  view.target = Vec3(numbers[3], numbers[4], numbers[5]);
  if (*view.eye == *view.target) refuse_camera(text);
  if (numbers.size() == 7) view.angle = numbers[6];
  if (!(view.angle >= 1 && view.angle <= 150))
    throw Error("--camera", "has an angle that is not between 1 and 150 degrees");
  return view;
}

AxisCut read_cut(std::string_view text) {
  const std::size_t axis = text.empty() ? std::string_view::npos : std::string_view("xyz").find(text[0]);
  const bool named = axis != std::string_view::npos && text.size() > 2 && text[1] == ':';
  const auto position = named ? read_number<double>(text.substr(2)) : std::nullopt;
  if (!position || !std::isfinite(*position))
    throw Error("--cut", fmt::format("'{}' is no cut", text), "give an axis and a place on it, as in y:0.5");
  return {static_cast<int>(axis), *position};
}

std::vector<std::int64_t> read_frames(std::string_view text, std::int64_t last_frame) {
  std::vector<std::int64_t> frames;
  for (const std::string_view item : split(text, ',')) {
    const auto ends = split(item, ':');
    if (ends.size() == 1) {
      frames.push_back(read_frame(ends[0], text, last_frame));
      continue;
    }
    const std::int64_t first = ends[0].empty() ? 0 : read_frame(ends[0], text, last_frame);
    const std::int64_t last = ends[1].empty() ? last_frame : read_frame(ends[1], text, last_frame);
    const auto step = ends.size() == 3 ? read_number<std::int64_t>(ends[2]) : std::optional<std::int64_t>(1);
    if (!step || *step < 1 || *step > std::int64_t{1'000'000'000} || ends.size() > 3 || last < first)
      throw Error("--frames", fmt::format("'{}' is no range of frames", item), "give FIRST:LAST or FIRST:LAST:STEP");
    for (std::int64_t frame = first; frame <= last; frame += *step) frames.push_back(frame);
  }
  return frames;
}

}  // namespace selvage::cli
