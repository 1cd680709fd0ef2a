#include "cli/arguments/mesh_input.h"
#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/json_text.h"
#include "cli/program/memory.h"
#include "cli/program/output.h"
#include "cli/reports/path_search.h"
#include "core/json.h"
#include "picture/paths_picture.h"
#include "selvage/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace selvage::cli {

namespace {

const std::vector<int> kPictureSize{1600, 1000};

struct PathsOptions {
  CommonOptions common;
  std::string mesh, points, csv, vtu, picture;
  bool planar = false, no_culling = false;
  std::vector<double> view;
  std::vector<int> picture_size = kPictureSize;
};

constexpr const char* kPathsExample =
    "  selvage make octopus --pose swirl -o octopus.vtu\n"
    "  selvage paths octopus.vtu --csv paths.csv --picture octopus.png\n"
    "  echo 0,0,0.2 | selvage paths octopus.vtu --points - --csv -\n"
    "\n"
    "Columns of CSV and JSON; in the plane b2 is empty:\n"
    "  query              vertex; with --points: number of the point, from 0\n"
    "  x,y,z              the point [m]\n"
    "  element            the element it is taken to be in; empty: none\n"
    "  found              1; or 0: no path, or the point is not in the element;\n"
    "                     then the columns of the answer are empty\n"
    "  face,face_id       vertices of the boundary face, and its number\n"
    "  b0,b1,b2           barycentric coordinates of the closest boundary point\n"
    "  sx,sy,sz,distance  that point, and how far it is [m]\n"
    "  feature            face, edge or vertex: where it lies\n"
    "  nx,ny,nz           outward normal there\n"
    "  volumes,faces,culled,traversals,elements\n"
    "                     counters of the search";

/// The direction from the mesh to the camera, of length 1.
Vec3 view_direction(const PathsOptions& options) {
  const Vec3 view(options.view[0], options.view[1], options.view[2]);
  const double largest = view.cwiseAbs().maxCoeff();
  if (!view.allFinite() || largest == 0) throw Error("--view", "is not a direction", "give three numbers, not all 0");
  return (view / largest).normalized();
}

/// Announces all outputs before any work is done.
void expect_outputs(const PathsOptions& options, OutputFiles& outputs) {
  std::vector<std::filesystem::path> inputs = files_of_mesh(options.mesh);
  if (!options.points.empty()) inputs.emplace_back(options.points);
  for (const std::string* path : {&options.common.json, &options.csv, &options.vtu, &options.picture}) {
    outputs.expect(*path, inputs);
  }
  const auto check_extension = [](const std::string& path, const char* option, const char* extension) {
    if (path.empty() || std::filesystem::path(path).extension() == extension) return;
    throw Error(path, fmt::format("{} writes {} files only", option, extension), "give it that extension");
  };
  check_extension(options.vtu, "--vtu", ".vtu");
  check_extension(options.picture, "--picture", ".png");
  if (!options.view.empty()) view_direction(options);
  if (options.picture.empty() && (!options.view.empty() || options.picture_size != kPictureSize))
    throw Error(options.view.empty() ? "--picture-size" : "--view", "has no effect without --picture",
                "add --picture FILE.png");
}

/// Whether the mesh is searched in the plane.
bool choose_planar(const PathsOptions& options, const IndexedMesh& file) {
  const bool planar = is_planar(file);
  if (options.planar && !planar) throw Error(options.mesh, "does not lie in the plane z = 0", "leave --planar out");
  if (!planar && file.tetrahedra.empty()) {
    throw Error(options.mesh, "is a surface in space, which has no inside", "give a tetrahedral or a planar mesh");
  }
  return planar;
}

Json counters_json(const PathCounters& c) {
  return {{"volumes", c.volumes_visited}, {"faces", c.faces_visited},       {"culled", c.culled},
          {"traversals", c.traversals},   {"elements", c.elements_visited}, {"exact_decisions", c.exact_decisions}};
}

std::string print_json(const PathsOptions& options, const SearchResult& result, const PathTotals& totals,
                       const Stopwatch& watch) {
  Json json{{"schema", 1}, {"kind", "paths"}, {"mesh", options.mesh}};
  json["queries"] = result.table.rows.size();
  json["found"] = totals.found;
  json["no_path"] = totals.no_path;
  json["not_in_element"] = totals.not_in_element;
  json["deepest"] = totals.deepest ? Json(totals.deepest->distance) : Json(nullptr);
  json["median"] = totals.deepest ? Json(totals.median) : Json(nullptr);
  json["defects"] = {{"inverted_elements", result.defects.inverted_elements},
                     {"degenerate_elements", result.defects.degenerate_elements},
                     {"overwound_interior_ridges", result.defects.overwound_interior_ridges},
                     {"overwound_boundary_ridges", result.defects.overwound_boundary_ridges}};
  Json end{{"statistics", counters_json(totals.counters)}};
  for (const auto& [phase, seconds] : watch.laps()) end["seconds"][phase] = seconds;
  end["seconds"]["total"] = watch.total();
  // The rows can be millions: they are printed as text between the two halves.
  std::string head = json_text(json), tail = json_text(end);
  head.resize(head.rfind('\n'));
  return head + ",\n \"paths\": " + print_json_rows(result.table) + "," + tail.substr(1) + "\n";
}

std::string caption(const PathsOptions& options, const SearchResult& result, const PathTotals& totals) {
  const std::size_t count = result.table.rows.size();
  std::string text =
      fmt::format("{} {}: {} {}{}", grouped(result.element_count), result.table.planar ? "triangles" : "tetrahedra",
                  grouped(static_cast<std::int64_t>(count)), options.points.empty() ? "penetrating " : "",
                  count == 1 ? "point" : "points");
  if (totals.deepest) text += fmt::format(", deepest {:.4g} m", totals.deepest->distance);
  return text;
}

Image draw(const PathsOptions& options, const IndexedMesh& file, const SearchResult& result, const PathTotals& totals) {
  std::vector<double> depth(file.positions.size(), -1);
  std::vector<DrawnPath> paths;
  for (const PathRow& row : result.table.rows) {
    if (options.points.empty()) depth[row.query] = std::max({depth[row.query], row.distance, 0.0});
    if (row.found()) paths.push_back({row.point, row.closest, row.distance});
  }
  PathsDrawing scene{file.positions, result.surface, result.outline, depth, paths, caption(options, result, totals)};
  PictureOptions picture;
  picture.width = options.picture_size[0];
  picture.height = options.picture_size[1];
  if (!options.view.empty()) picture.towards = view_direction(options);
  return draw_paths(scene, picture);
}

void print_summary(const PathsOptions& options, const SearchResult& result, const PathTotals& totals,
                   const Stopwatch& watch) {
  const auto rows = static_cast<std::int64_t>(result.table.rows.size());
  Table table;
  table.add("mesh", fmt::format("{}, {} {}", options.mesh, grouped(result.element_count),
                                result.table.planar ? "triangles" : "tetrahedra"));
  table.add(options.points.empty() ? "penetrating points" : "points", grouped(rows));
  table.add("paths found", grouped(totals.found));
  if (totals.no_path) table.add("without a path", grouped(totals.no_path));
  if (totals.not_in_element) table.add("not in the element", grouped(totals.not_in_element));
  if (totals.deepest) {
    table.add("deepest", fmt::format("{:.6g} m, at {} {}", totals.deepest->distance,
                                     options.points.empty() ? "vertex" : "point", totals.deepest->query));
    table.add("median depth", fmt::format("{:.6g} m", totals.median));
  }
  const MeshDefects& d = result.defects;
  if (d.inverted_elements + d.degenerate_elements > 0) {
    table.add(
        "inverted, flat",
        fmt::format("{}, {} elements: paths through them follow the rules for inverted elements, which no theorem "
                    "covers",
                    grouped(d.inverted_elements), grouped(d.degenerate_elements)));
  }
  std::string times;
  for (const auto& [phase, seconds] : watch.laps()) times += fmt::format("{} {}, ", phase, readable_seconds(seconds));
  table.add("time", fmt::format("{}total {}", times, readable_seconds(watch.total())));
  table.print();
}

void write_outputs(const PathsOptions& options, const SearchResult& result, const PathTotals& totals,
                   const std::optional<Image>& image, const Stopwatch& watch, OutputFiles& outputs) {
  if (!options.csv.empty()) outputs.write_text(options.csv, print_csv(result.table));
  if (!options.common.json.empty()) outputs.write_text(options.common.json, print_json(options, result, totals, watch));
  if (!options.vtu.empty()) {
    outputs.write_file(options.vtu, [&](const auto& path) { write_vtu(path, path_lines(result.table)); });
  }
  if (image) outputs.write_file(options.picture, [&](const auto& path) { write_png(path, *image); });
  outputs.commit();
}

void run_paths(const PathsOptions& options) {
  Stopwatch watch;
  take_large_pages();
  OutputFiles outputs;
  expect_outputs(options, outputs);
  const IndexedMesh file = read_mesh(options.mesh);
  const bool planar = choose_planar(options, file);
  watch.lap("read");

  SearchRequest request;
  if (!options.points.empty()) request.points_file = options.points;
  request.options.cull_infeasible_regions = !options.no_culling;
  request.count = !options.common.json.empty() || !options.csv.empty();
  request.quiet = options.common.quiet;
  const SearchResult result = planar ? search_paths<2>(file, request, watch) : search_paths<3>(file, request, watch);
  const PathTotals totals = total_paths(result.table);
  std::optional<Image> image;
  if (!options.picture.empty()) {
    image = draw(options, file, result, totals);
    watch.lap("picture");
  }
  write_outputs(options, result, totals, image, watch, outputs);
  watch.lap("write");
  if (!options.common.quiet && !outputs.uses_standard_output()) print_summary(options, result, totals, watch);
}

}  // namespace

Command add_paths(CLI::App& app) {
  auto options = std::make_shared<PathsOptions>();
  CLI::App* sub = add_subcommand(app, "paths",
                                 "Finds shortest paths to the boundary: for every boundary vertex that lies inside an "
                                 "element it does not belong to, or for given points.",
                                 kPathsExample);
  sub->add_option("mesh", options->mesh, "Tetrahedral mesh, or triangles in the plane z = 0")
      ->required()
      ->type_name("MESH");
  sub->add_option("--points", options->points,
                  "Query points: x,y,z or x,y,z,element on each line; without an element, one answer for every "
                  "element that contains the point; - is standard input")
      ->type_name("FILE.csv");
  sub->add_option("--csv", options->csv, "Write the answers as CSV; - is standard output")->type_name("FILE");
  sub->add_option("--vtu", options->vtu, "Write the paths as lines with their depth, for ParaView")
      ->type_name("FILE.vtu");
  sub->add_option("--picture", options->picture, "Draw the mesh and the paths")->type_name("FILE.png");
  auto* size = sub->add_option("--picture-size", options->picture_size,
                               "Width and height, from 64 to 8192 [pixels] (1600 1000)");
  size->expected(2)->check(CLI::Range(64, 8192))->type_name("W H");
  sub->add_option("--view", options->view, "Direction from the mesh to the camera")->expected(3)->type_name("X Y Z");
  sub->add_flag("--planar", options->planar, "Require a mesh of triangles in the plane z = 0");
  sub->add_flag("--no-culling", options->no_culling, "Search without infeasible-region culling; same answers");
  return {sub, &options->common, [options] {
            run_paths(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
