#include "cli/reports/collision_report.h"
#include "core/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::cli {

namespace {

constexpr std::array<const char*, 4> kContactNames{"near", "touching", "crossing", "coplanar overlap"};

const char* contact_name(TriangleContact contact) {
  return kContactNames[static_cast<std::size_t>(contact)];
}

/// Lists as text, one entry a line: there can be millions.
template <typename Items, typename Print>
std::string print_list(const Items& items, Print&& print) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "[");
  for (std::size_t i = 0; i < items.size(); ++i) {
    fmt::format_to(std::back_inserter(out), "{}\n  ", i ? "," : "");
    print(std::back_inserter(out), items[i]);
  }
  fmt::format_to(std::back_inserter(out), "{}]", items.empty() ? "" : "\n ");
  return fmt::to_string(out);
}

/// Calls `visit(triangle)` for each triangle of each pair, and for each vertex that meets a face and each edge the
/// vertices with `visit_vertex(vertex)`.
template <typename Visit, typename VisitVertex>
void visit_pairs(const CollisionReport& report, Visit&& visit, VisitVertex&& visit_vertex) {
  for (const TrianglePair& pair : report.pairs) {
    visit(pair.first);
    visit(pair.second);
  }
  for (const VertexFacePair& pair : report.moving_pairs.vertex_face) {
    visit_vertex(pair.vertex);
    visit(pair.face);
  }
  for (const EdgeEdgePair& pair : report.moving_pairs.edge_edge)
    for (const Index e : {pair.first, pair.second})
      for (const Index v : report.surface.edges()[e]) visit_vertex(v);
}

/// In how many pairs each triangle is, and each vertex by itself or in an edge.
struct PairCounts {
  std::vector<std::int64_t> of_triangles, of_vertices;

  explicit PairCounts(const CollisionReport& report)
      : of_triangles(report.surface.triangles().size(), 0), of_vertices(report.positions.size(), 0) {
    visit_pairs(
        report, [&](Index t) { ++of_triangles[t]; }, [&](Index v) { ++of_vertices[v]; });
  }
};

/// The corners of the box around all that collides, at the start of the step.
std::pair<Vec3, Vec3> place_of(const CollisionReport& report) {
  Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower;
  const auto add = [&](Index v) {
    lower = lower.cwiseMin(report.positions[v]);
    upper = upper.cwiseMax(report.positions[v]);
  };
  visit_pairs(
      report,
      [&](Index t) {
        for (const Index v : report.surface.triangles()[t]) add(v);
      },
      add);
  return {lower, upper};
}

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
  add(std::ssize(report.moving_pairs.vertex_face), "of a vertex and a face");
  add(std::ssize(report.moving_pairs.edge_edge), "of two edges");
  return text;
}

Json statistics_json(const CollisionReport& report, const SelfCollisionCounters& c) {
  return {{"triangles", report.surface.triangles().size()},
          {"pairs", report.pairs.size()},
          {"node_pairs", c.node_pairs},
          {"box_pairs", c.box_pairs},
          {"adjacent_pairs", c.adjacent_pairs},
          {"tested_nodes", c.tested_nodes},
          {"culled_nodes", c.culled_nodes},
          {"culled_triangles", c.culled_triangles},
          {"exact_tests", c.exact_tests}};
}

Json statistics_json(const CollisionReport& report, const ContinuousCounters& c) {
  return {{"triangles", report.surface.triangles().size()},
          {"vertex_face", report.moving_pairs.vertex_face.size()},
          {"edge_edge", report.moving_pairs.edge_edge.size()},
          {"node_pairs", c.node_pairs},
          {"box_pairs", c.box_pairs},
          {"vertex_face_boxes", c.vertex_face_boxes},
          {"edge_edge_boxes", c.edge_edge_boxes},
          {"tested_nodes", c.tested_nodes},
          {"culled_nodes", c.culled_nodes},
          {"culled_triangles", c.culled_triangles},
          {"exact_tests", c.exact_tests}};
}

std::string print_triangle_pairs(const CollisionReport& report) {
  return ",\n \"triangle_pairs\": " +
         print_list(
             report.pairs,
             [](auto out, const TrianglePair& pair) { fmt::format_to(out, "[{},{}]", pair.first, pair.second); }) +
         ",\n \"contacts\": " + print_list(report.pairs, [](auto out, const TrianglePair& pair) {
           fmt::format_to(out, "\"{}\"", contact_name(pair.contact));
         });
}

std::string print_segments(const CollisionReport& report) {
  return ",\n \"segments\": " + print_list(report.segments, [](auto out, const CommonSegment& segment) {
           if (!segment) {
             fmt::format_to(out, "null");
             return;
           }
           const auto& [p, q] = *segment;
           fmt::format_to(out, "[[{},{},{}],[{},{},{}]]", p[0], p[1], p[2], q[0], q[1], q[2]);
         });
}

std::string print_moving_pairs(const CollisionReport& report) {
  const ContinuousPairs& pairs = report.moving_pairs;
  return ",\n \"vertex_face\": " +
         print_list(
             pairs.vertex_face,
             [](auto out, const VertexFacePair& pair) { fmt::format_to(out, "[{},{}]", pair.vertex, pair.face); }) +
         ",\n \"edge_edge\": " + print_list(pairs.edge_edge, [&](auto out, const EdgeEdgePair& pair) {
           const auto &a = report.surface.edges()[pair.first], &b = report.surface.edges()[pair.second];
           fmt::format_to(out, "[{},{},{},{}]", a[0], a[1], b[0], b[1]);
         });
}

}  // namespace

std::string print_json(const CollisionReport& report, const Stopwatch& watch) {
  const bool moves = !report.end_mesh.empty();
  Json head{{"schema", 1}, {"kind", moves ? "continuous" : "discrete"}, {"mesh", report.mesh}};
  if (moves) head["to"] = report.end_mesh;
  head["method"] = report.method;
  Json tail;
  if (moves) tail["free_step"] = report.free_step;
  tail["statistics"] =
      moves ? statistics_json(report, report.moving_counters) : statistics_json(report, report.counters);
  for (const auto& [phase, seconds] : watch.laps()) tail["seconds"][phase] = seconds;
  tail["seconds"]["total"] = watch.total();
  std::string text = head.dump(1);
  text.resize(text.rfind('\n'));
  if (report.solid)
    text += ",\n \"triangles\": " + print_list(report.surface.triangles(), [](auto out, const VertexTuple<3>& t) {
              fmt::format_to(out, "[{},{},{}]", t[0], t[1], t[2]);
            });
  text += moves ? print_moving_pairs(report) : print_triangle_pairs(report);
  if (report.has_segments) text += print_segments(report);
  return text + "," + tail.dump(1).substr(1) + "\n";
}

VtkGrid mark_collisions(const CollisionReport& report) {
  VtkGrid grid;
  grid.points = report.positions;
  grid.triangles.assign(report.surface.triangles().begin(), report.surface.triangles().end());
  const PairCounts counts(report);
  grid.cell_fields.push_back({"collisions", 1, {counts.of_triangles.begin(), counts.of_triangles.end()}});
  if (!report.end_mesh.empty())
    grid.point_fields.push_back({"collisions", 1, {counts.of_vertices.begin(), counts.of_vertices.end()}});
  return grid;
}

std::string print_free_step(double fraction) {
  if (fraction == 1) return "the whole step";
  return fraction > 0 ? fmt::format("until {:.6g} of the step", fraction) : "no part of the step";
}

void print_summary(const CollisionReport& report, const Stopwatch& watch) {
  Table table;
  table.add("mesh", fmt::format("{}, {} {}", report.mesh, grouped(report.surface.triangle_count()),
                                report.solid ? "boundary triangles" : "triangles"));
  if (!report.end_mesh.empty()) table.add("to", report.end_mesh);
  table.add("colliding pairs",
            report.is_clean() ? "none" : fmt::format("{}: {}", grouped(count_all(report)), print_kinds(report)));
  if (!report.is_clean()) {
    const std::vector<std::int64_t> counts = PairCounts(report).of_triangles;
    const auto most = std::max_element(counts.begin(), counts.end());
    const auto [lower, upper] = place_of(report);
    table.add("triangles in pairs",
              fmt::format("{}; triangle {} has the most pairs, {}",
                          grouped(std::count_if(counts.begin(), counts.end(), [](std::int64_t n) { return n > 0; })),
                          most - counts.begin(), grouped(*most)));
    table.add("where", fmt::format("from {:.6g} {:.6g} {:.6g} to {:.6g} {:.6g} {:.6g} m", lower[0], lower[1], lower[2],
                                   upper[0], upper[1], upper[2]));
  }
  if (!report.end_mesh.empty()) table.add("free of collisions", print_free_step(report.free_step));
  std::string times;
  for (const auto& [phase, seconds] : watch.laps()) times += fmt::format("{} {}, ", phase, readable_seconds(seconds));
  table.add("time", fmt::format("{}total {}", times, readable_seconds(watch.total())));
  table.print();
}

}  // namespace selvage::cli
