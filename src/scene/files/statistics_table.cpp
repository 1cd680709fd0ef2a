#include "scene/files/statistics_table.h"

#include "selvage/core/error.h"

#include <fmt/format.h>

#include <charconv>
#include <variant>

namespace selvage {

namespace {

using Row = FrameStatistics;

struct Column {
  std::string_view name;
  std::variant<std::int64_t Row::*, double Row::*> member;
};

constexpr std::array kColumns{
    Column{"frame", &Row::frame},
    Column{"time", &Row::time},
    Column{"steps", &Row::steps},
    Column{"vertex_paths", &Row::vertex_paths},
    Column{"edge_paths", &Row::edge_paths},
    Column{"centroid_paths", &Row::centroid_paths},
    Column{"vertex_faces", &Row::vertex_faces},
    Column{"edge_edges", &Row::edge_edges},
    Column{"collider_contacts", &Row::collider_contacts},
    Column{"path_queries", &Row::path_queries},
    Column{"blocked_paths", &Row::blocked_paths},
    Column{"constraints", &Row::constraints},
    Column{"newton_steps", &Row::newton_steps},
    Column{"linear_iterations", &Row::linear_iterations},
    Column{"residual", &Row::residual},
    Column{"held_back_vertices", &Row::held_back_vertices},
    Column{"impacts_met", &Row::impacts_met},
    Column{"impacts_left", &Row::impacts_left},
    Column{"unguarded_vertices", &Row::unguarded_vertices},
    Column{"halved_steps", &Row::halved_steps},
    Column{"resolved_bodies", &Row::resolved_bodies},
    Column{"sleeping_bodies", &Row::sleeping_bodies},
    Column{"penetrating_vertices", &Row::penetrating_vertices},
    Column{"deepest_penetration", &Row::deepest_penetration},
    Column{"penetrating_edges", &Row::penetrating_edges},
    Column{"deepest_edge", &Row::deepest_edge},
    Column{"triangle_pairs", &Row::triangle_pairs},
    Column{"vertices_in_colliders", &Row::vertices_in_colliders},
    Column{"deepest_in_colliders", &Row::deepest_in_colliders},
    Column{"collider_points", &Row::collider_points},
    Column{"deepest_collider_point", &Row::deepest_collider_point},
    Column{"inverted_elements", &Row::inverted_elements},
    Column{"flat_elements", &Row::flat_elements},
    Column{"kinetic_energy", &Row::kinetic_energy},
    Column{"elastic_energy", &Row::elastic_energy},
    Column{"gravity_energy", &Row::gravity_energy},
    Column{"objective", &Row::objective},
    Column{"fastest", &Row::fastest},
    // Costs follow.
    Column{"volumes", &Row::volumes},
    Column{"traversals", &Row::traversals},
    Column{"path_elements", &Row::path_elements},
    Column{"seconds_start", &Row::seconds_start},
    Column{"seconds_material", &Row::seconds_material},
    Column{"seconds_projection", &Row::seconds_projection},
    Column{"seconds_dcd", &Row::seconds_dcd},
    Column{"seconds_paths", &Row::seconds_paths},
    Column{"seconds_ccd", &Row::seconds_ccd},
    Column{"seconds_steps", &Row::seconds_steps},
    Column{"seconds_frame", &Row::seconds_frame},
};

/// Cuts the text up to the next separator off the front.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

bool parse_row(std::string_view line, Row& row) {
  for (const Column& column : kColumns) {
    const std::string_view cell = cut(line, ',');
    const bool read = std::visit(
        [&](auto member) {
          const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), row.*member);
          return error == std::errc() && end == cell.data() + cell.size();
        },
        column.member);
    if (!read) return false;
  }
  return line.empty();
}

}  // namespace

std::string statistics_header() {
  std::string line;
  for (const Column& column : kColumns) line += fmt::format("{}{}", line.empty() ? "" : ",", column.name);
  return line + "\n";
}

std::string statistics_row(const FrameStatistics& row) {
  std::string line;
  for (const Column& column : kColumns)
    std::visit([&](auto member) { line += fmt::format("{}{}", line.empty() ? "" : ",", row.*member); }, column.member);
  return line + "\n";
}

std::vector<FrameStatistics> parse_statistics(std::string_view text, const std::string& name, std::int64_t last_frame) {
  if (cut(text, '\n') != statistics_header().substr(0, statistics_header().size() - 1))
    throw Error(fmt::format("{}:1", name), "has other columns", "run the scene anew");
  std::vector<FrameStatistics> rows;
  while (std::ssize(rows) <= last_frame) {
    const bool whole = text.find('\n') != std::string_view::npos;
    FrameStatistics row;
    if (!whole || !parse_row(cut(text, '\n'), row) || row.frame != std::ssize(rows))
      throw Error(fmt::format("{}:{}", name, rows.size() + 2), "is damaged", "run the scene anew");
    rows.push_back(row);
  }
  return rows;
}

}  // namespace selvage
