#include "cli/arguments/points_file.h"

#include "cli/arguments/numbers.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>

namespace selvage::cli {

namespace {

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    fields.push_back(trim(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

/// Reads one line of a points file; `place` says where it stands.
AskedPoint parse_point(std::string_view line, const std::string& place, Index element_count) {
  const auto fields = split(line);
  if (fields.size() != 3 && fields.size() != 4) {
    throw Error(place, fmt::format("{} fields, where 3 or 4 are expected", fields.size()),
                "write x,y,z or x,y,z,element");
  }
  AskedPoint asked;
  for (int i = 0; i < 3; ++i) {
    const auto coordinate = read_number<double>(fields[i]);
    if (!coordinate) throw Error(place, fmt::format("'{}' is not a number", fields[i]));
    if (!std::isfinite(*coordinate)) throw Error(place, fmt::format("'{}' is not finite", fields[i]));
    asked.point[i] = *coordinate;
  }
  if (fields.size() == 3 || fields[3].empty()) return asked;
  const auto element = read_number<std::int64_t>(fields[3]);
  if (!element) throw Error(place, fmt::format("'{}' is not an element number", fields[3]));
  if (*element < 0 || *element >= element_count) {
    throw Error(place, fmt::format("there is no element {}", *element),
                fmt::format("elements are numbered from 0 to {}", element_count - 1));
  }
  asked.element = static_cast<Index>(*element);
  return asked;
}

/// A first line of words, as `x,y,z`: a line of numbers with one that is broken is no header.
bool is_header(std::string_view line) {
  for (const std::string_view field : split(line)) {
    if (field.empty() || read_number<double>(field)) return false;
    const char first = field[0];
    if ((first >= '0' && first <= '9') || first == '-' || first == '+' || first == '.') return false;
  }
  return true;
}

}  // namespace

std::vector<AskedPoint> read_points(const std::filesystem::path& path, Index element_count) {
  std::ifstream file(path == "-" ? "/dev/stdin" : path);
  if (!file) throw Error(path.string(), "cannot be read", "check the name");
  std::vector<AskedPoint> points;
  std::string text;
  bool first = true;
  for (int line = 1; std::getline(file, text); ++line) {
    const std::string_view content = trim(text);
    if (content.empty() || content[0] == '#') continue;
    const bool header = first && is_header(content);
    first = false;
    if (header) continue;
    points.push_back(parse_point(content, fmt::format("{}:{}", path.string(), line), element_count));
    points.back().line = line;
  }
  if (file.bad()) throw Error(path.string(), "cannot be read to its end");
  if (points.empty()) throw Error(path.string(), "there is no point", "write one x,y,z on each line");
  return points;
}

}  // namespace selvage::cli
