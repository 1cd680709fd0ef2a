#include "cli/reports/collision_marks.h"
#include "cli/reports/collision_report.h"
#include "core/json.h"

#include <fmt/format.h>

#include <algorithm>

namespace selvage::cli {

namespace {

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

/// The same as a further member.
template <typename Items, typename Print>
std::string print_member(std::string_view name, const Items& items, Print&& print) {
  return fmt::format(",\n \"{}\": ", name) + print_list(items, print);
}

constexpr auto print_number = [](auto out, auto number) { fmt::format_to(out, "{}", number); };

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
  return print_member("triangle_pairs", report.pairs,
                      [&](auto out, const TrianglePair& pair) {
                        fmt::format_to(out, "[{},{}]", report.number_in_file(pair.first),
                                       report.number_in_file(pair.second));
                      }) +
         print_member("contacts", report.pairs, [](auto out, const TrianglePair& pair) {
           fmt::format_to(out, "\"{}\"", contact_name(pair.contact));
         });
}

/// Of files with polygons: the face that each triangle is a part of, and the pairs of faces.
std::string print_faces(const CollisionReport& report) {
  const auto list = [](std::string_view name, const CheckedSurface& mesh, Index count) {
    std::vector<Index> faces;
    for (Index t = 0; t < count; ++t) faces.push_back(mesh.face_of(t));
    return print_member(name, faces, print_number);
  };
  std::string text = list("faces", report.first, report.first_triangles());
  if (report.second) text += list("faces_against", *report.second, report.second->surface.triangle_count());
  if (report.moves()) return text;
  std::vector<IndexPair> pairs;
  for (const TrianglePair& pair : report.pairs) {
    IndexPair faces(report.face_in_file(pair.first), report.face_in_file(pair.second));
    if (!report.second && faces.first > faces.second) std::swap(faces.first, faces.second);
    pairs.push_back(faces);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return text + print_member("face_pairs", pairs, [](auto out, const IndexPair& pair) {
           fmt::format_to(out, "[{},{}]", pair.first, pair.second);
         });
}

std::string print_segments(const CollisionReport& report) {
  return print_member("segments", report.segments, [](auto out, const CommonSegment& segment) {
    if (!segment) {
      fmt::format_to(out, "null");
      return;
    }
    const auto& [p, q] = *segment;
    fmt::format_to(out, "[[{},{},{}],[{},{},{}]]", p[0], p[1], p[2], q[0], q[1], q[2]);
  });
}

/// Pairs of features; of two meshes the first number is always of the first. With distances where there are any.
std::string print_feature_pairs(const CollisionReport& report) {
  std::vector<std::size_t> vertex_first, face_first;  // which part is of the first mesh
  const std::vector<VertexFacePair>& pairs = report.moving_pairs.vertex_face;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    (report.second && !report.is_of_second_mesh(pairs[i].face) ? face_first : vertex_first).push_back(i);
  const auto distances = [&](std::string_view name, std::span<const std::size_t> of) {
    return print_member(
        name, of, [&](auto out, std::size_t i) { fmt::format_to(out, "{}", report.near.vertex_face[i].distance); });
  };
  const bool has_distances = !report.moves();
  std::string text = print_member("vertex_face", vertex_first, [&](auto out, std::size_t i) {
    fmt::format_to(out, "[{},{}]", report.vertex_in_file(pairs[i].vertex), report.number_in_file(pairs[i].face));
  });
  if (has_distances) text += distances("vertex_face_distances", vertex_first);
  if (report.second) {
    text += print_member("face_vertex", face_first, [&](auto out, std::size_t i) {
      fmt::format_to(out, "[{},{}]", report.number_in_file(pairs[i].face), report.vertex_in_file(pairs[i].vertex));
    });
    if (has_distances) text += distances("face_vertex_distances", face_first);
  }
  text += print_member("edge_edge", report.moving_pairs.edge_edge, [&](auto out, const EdgeEdgePair& pair) {
    const auto &a = report.surface.edges()[pair.first], &b = report.surface.edges()[pair.second];
    const auto number = [&](Index v) { return report.vertex_in_file(v); };
    fmt::format_to(out, "[{},{},{},{}]", number(a[0]), number(a[1]), number(b[0]), number(b[1]));
  });
  if (!has_distances) return text;
  return text + print_member("edge_edge_distances", report.near.edge_edge,
                             [](auto out, const NearEdges& pair) { fmt::format_to(out, "{}", pair.distance); });
}

const char* kind_of(const CollisionReport& report) {
  if (report.moves()) return "continuous";
  return report.thickness > 0 ? "near" : "discrete";
}

}  // namespace

std::string print_json(const CollisionReport& report, const Stopwatch& watch) {
  const bool moves = report.moves();
  Json head{{"schema", 1}, {"kind", kind_of(report)}, {"mesh", report.first.file}};
  if (moves) head["to"] = report.end_file;
  if (report.second) head["against"] = report.second->file;
  head["method"] = report.method;
  if (report.thickness > 0) head["thickness"] = report.thickness;
  if (report.first.is_welded) head["weld"] = true;
  const std::string hint = unshared_hint(report);
  if (!hint.empty()) head["hint"] = hint;
  Json tail;
  if (moves) tail["free_step"] = report.free_step;
  if (moves && report.thickness > 0) tail["separated_step"] = report.separated_step;
  tail["statistics"] =
      moves ? statistics_json(report, report.moving_counters) : statistics_json(report, report.counters);
  for (const auto& [phase, seconds] : watch.laps()) tail["seconds"][phase] = seconds;
  tail["seconds"]["total"] = watch.total();
  std::string text = head.dump(1, ' ', false, Json::error_handler_t::replace);
  text.resize(text.rfind('\n'));
  const auto print_triangle = [](auto out, const VertexTuple<3>& t) {
    fmt::format_to(out, "[{},{},{}]", t[0], t[1], t[2]);
  };
  if (report.first.is_solid)
    text += print_member("triangles", report.surface.triangles().first(report.first_triangles()), print_triangle);
  if (report.second && report.second->is_solid)
    text += print_member("triangles_against", report.second->surface.triangles(), print_triangle);
  if (report.has_polygons()) text += print_faces(report);
  if (!moves) text += print_triangle_pairs(report);
  if (report.has_segments) text += print_segments(report);
  if (moves || report.thickness > 0) text += print_feature_pairs(report);
  return text + "," + tail.dump(1).substr(1) + "\n";
}

}  // namespace selvage::cli
