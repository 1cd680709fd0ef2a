#include "cli/reports/collision_report.h"

#include "cli/reports/collision_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace selvage::cli {

namespace {

std::int64_t count_all(const CollisionReport& report) {
  return std::ssize(report.pairs) + std::ssize(report.moving_pairs.vertex_face) +
         std::ssize(report.moving_pairs.edge_edge);
}

std::string print_kinds(const CollisionReport& report) {
  std::string text;
  const auto add = [&](std::int64_t count, const char* kind) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(count), kind);
  };
  for (const TriangleContact contact :
       {TriangleContact::kCrossing, TriangleContact::kTouching, TriangleContact::kCoplanarOverlap})
    add(std::count_if(report.pairs.begin(), report.pairs.end(),
                      [&](const TrianglePair& pair) { return pair.contact == contact; }),
        contact_name(contact));
  if (!report.moves()) return text;
  add(std::ssize(report.moving_pairs.vertex_face), "of a vertex and a face");
  add(std::ssize(report.moving_pairs.edge_edge), "of two edges");
  return text;
}

std::string print_near(const CollisionReport& report) {
  double least = HUGE_VAL;
  for (const NearVertexFace& pair : report.near.vertex_face) least = std::min(least, pair.distance);
  for (const NearEdges& pair : report.near.edge_edge) least = std::min(least, pair.distance);
  const std::string within = fmt::format("within {:.6g} m", report.thickness);
  if (report.near.empty()) return "none " + within;
  return fmt::format("{} of a vertex and a face, {} of two edges {}; least {:.6g} m",
                     grouped(std::ssize(report.near.vertex_face)), grouped(std::ssize(report.near.edge_edge)), within,
                     least);
}

std::string print_mesh(const CheckedSurface& mesh, Index triangles, bool has_polygons) {
  std::string text =
      fmt::format("{}, {} {}", mesh.file, grouped(triangles), mesh.is_solid ? "boundary triangles" : "triangles");
  if (has_polygons && triangles > 0 && !mesh.faces.empty())
    text += fmt::format(" of {} faces", grouped(1 + *std::max_element(mesh.faces.begin(), mesh.faces.end())));
  return text;
}

/// How many triangles, or faces of a file with polygons, are in pairs, and which is in the most.
void add_parts(const CollisionReport& report, Table& table) {
  const std::vector<std::int64_t> counts = PairCounts(report).of_triangles;
  const char* const part = report.has_polygons() ? "face" : "triangle";
  std::map<std::pair<bool, Index>, std::int64_t> of_faces;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto t = static_cast<Index>(i);
    if (counts[i] > 0) of_faces[{report.is_of_second_mesh(t), report.face_in_file(t)}] += counts[i];
  }
  if (of_faces.empty()) return;
  const auto most = std::max_element(of_faces.begin(), of_faces.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  const bool is_second = most->first.first;
  table.add(fmt::format("{}s in pairs", part),
            fmt::format("{}; {} {}{} has the most pairs, {}", grouped(std::ssize(of_faces)), part, most->first.second,
                        report.second ? " of " + (is_second ? *report.second : report.first).file : "",
                        grouped(most->second)));
}

std::string print_step(double fraction) {
  if (fraction == 1) return "the whole step";
  return fraction > 0 ? fmt::format("until {:.6g} of the step", fraction) : "no part of the step";
}

}  // namespace

void print_summary(const CollisionReport& report, const Stopwatch& watch) {
  Table table;
  table.add("mesh", print_mesh(report.first, report.first_triangles(), report.has_polygons()));
  if (report.second)
    table.add("against", print_mesh(*report.second, report.second->surface.triangle_count(), report.has_polygons()));
  if (report.moves()) table.add("to", report.end_file);
  const bool is_near = report.thickness > 0 && !report.moves();
  const std::int64_t meeting = is_near ? std::ssize(report.pairs) : count_all(report);
  table.add("colliding pairs", meeting == 0 ? "none" : fmt::format("{}: {}", grouped(meeting), print_kinds(report)));
  if (is_near) table.add("near pairs", print_near(report));
  if (!report.is_clean()) {
    const auto [lower, upper] = place_of_collisions(report);
    add_parts(report, table);
    table.add("where", fmt::format("from {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g} m", lower[0], lower[1], lower[2],
                                   upper[0], upper[1], upper[2]));
  }
  if (report.moves()) table.add("free of collisions", print_step(report.free_step));
  if (report.moves() && report.thickness > 0)
    table.add(fmt::format("{:.6g} m apart", report.thickness), print_step(report.separated_step));
  const std::string hint = unshared_hint(report);
  if (!hint.empty()) table.add("hint", hint);
  std::string times;
  for (const auto& [phase, seconds] : watch.laps()) times += fmt::format("{} {}, ", phase, readable_seconds(seconds));
  table.add("time", fmt::format("{}total {}", times, readable_seconds(watch.total())));
  table.print();
}

}  // namespace selvage::cli
