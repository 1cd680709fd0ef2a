#include "cli/arguments/vertex_list.h"

#include "cli/arguments/numbers.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <fstream>

namespace selvage::cli {

std::vector<Index> read_vertices(const std::filesystem::path& path, Index vertex_count) {
  std::ifstream file(path);
  if (!file) throw Error(path.string(), "cannot be read", "check the name");
  std::vector<Index> vertices;
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    const std::string_view content = trim(std::string_view(text).substr(0, text.find('#')));
    if (content.empty()) continue;
    const std::string place = fmt::format("{}:{}", path.string(), line);
    const auto vertex = read_number<std::int64_t>(content);
    if (!vertex) throw Error(place, fmt::format("'{}' is not a vertex number", content), "write one on each line");
    if (*vertex < 0 || *vertex >= vertex_count)
      throw Error(place, fmt::format("there is no vertex {}", *vertex),
                  fmt::format("vertices are numbered from 0 to {}", vertex_count - 1));
    vertices.push_back(static_cast<Index>(*vertex));
  }
  if (file.bad()) throw Error(path.string(), "cannot be read to its end");
  return vertices;
}

}  // namespace selvage::cli
