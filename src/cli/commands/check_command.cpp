#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/memory.h"
#include "cli/program/output.h"
#include "cli/reports/collision_marks.h"
#include "cli/reports/collision_report.h"
#include "selvage/core/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

namespace selvage::cli {

namespace {

struct CheckOptions {
  CommonOptions common;
  std::string mesh, end_mesh, against, method = "auto", groups, vtu, ply, picture;
  std::optional<double> thickness;
  int rings = 0;
  bool adjacent = false, segments = false, weld = false;
};

constexpr const char* kCheckExample =
    "  selvage make rod -o rod.vtu\n"
    "  selvage make rod --pose self-crossing -o bent.vtu\n"
    "  selvage check bent.vtu --adjacent --json pairs.json --vtu marked.vtu\n"
    "  selvage check rod.vtu --to bent.vtu\n"
    "  selvage check bent.vtu --thickness 0.02 --rings 2 --picture near.png\n"
    "  selvage make ball --radius 0.5 -o ball.vtu\n"
    "  selvage check rod.vtu --against ball.vtu --ply marked.ply\n"
    "\n"
    "Exit status: 0 no pair, 1 pairs, 2 bad usage or bad input, 3 the computation failed.\n"
    "\n"
    "In JSON, `triangle_pairs` are pairs of triangle numbers, from 0, in the order of the file; of a tetrahedral "
    "mesh, in the order of `triangles`, which lists their vertices. `contacts` gives the kind of each pair: "
    "crossing, touching or a coplanar overlap. With --segments, `segments` has for each pair the ends of what both "
    "triangles have in common, or null where they overlap in one plane. With --to, `vertex_face` are pairs of a vertex "
    "and a triangle, `edge_edge` the vertices of two edges, and `free_step` is the largest fraction of the step "
    "without collisions. With --thickness these two lists are of what is nearer, and beside each stand the distances, "
    "as `vertex_face_distances`. With --against, the first number of a pair is of MESH, the second of B; `face_vertex` "
    "are pairs of a triangle of MESH and a vertex of B. Of files with polygons, `faces` gives the file's face, from 0, "
    "of each triangle, and `face_pairs` the pairs of faces.\n"
    "The .vtu file holds the surface with the number of each triangle's pairs in `collisions`, the .ply file colours: "
    "vermilion meets something, yellow is nearer than the thickness. `selvage render pairs.json` draws from other "
    "sides.";

void expect_extension(const std::string& path, const char* option, const char* extension) {
  if (path.empty() || std::filesystem::path(path).extension() == extension) return;
  throw Error(path, fmt::format("{} writes {} files only", option, extension), "give it that extension");
}

/// Refuses options that have no meaning together.
void check_options(const CheckOptions& options) {
  culling_method(options.method);
  const auto refuse = [](bool wrong, const char* option, const char* why, const char* remedy) {
    if (wrong) throw Error(option, why, remedy);
  };
  const bool moves = !options.end_mesh.empty(), has_two = !options.against.empty();
  refuse(options.adjacent && moves, "--adjacent", "does not apply to a step", "leave out --adjacent or --to");
  refuse(options.segments && moves, "--segments", "does not apply to a step", "leave out --segments or --to");
  refuse(options.segments && options.common.json.empty(), "--segments", "has no effect without --json",
         "add --json FILE");
  refuse(options.adjacent && has_two, "--adjacent", "has no meaning for two meshes", "leave out --adjacent");
  refuse(options.rings > 0 && has_two, "--rings", "has no meaning for two meshes", "leave out --rings");
  refuse(!options.groups.empty() && has_two, "--groups", "has no meaning for two meshes", "leave out --groups");
  if (options.thickness && !(*options.thickness > 0 && std::isfinite(*options.thickness)))
    throw Error("--thickness", fmt::format("is {}", *options.thickness), "give a length above 0");
  expect_extension(options.vtu, "--vtu", ".vtu");
  expect_extension(options.ply, "--ply", ".ply");
  expect_extension(options.picture, "--picture", ".png");
}

void expect_outputs(const CheckOptions& options, OutputFiles& outputs) {
  std::vector<std::filesystem::path> inputs;
  for (const std::string* mesh : {&options.mesh, &options.end_mesh, &options.against})
    if (!mesh->empty())
      for (const auto& path : files_of_mesh(*mesh)) inputs.push_back(path);
  if (!options.groups.empty()) inputs.emplace_back(options.groups);
  for (const std::string* path : {&options.common.json, &options.vtu, &options.ply, &options.picture})
    outputs.expect(*path, inputs);
}

CollisionReport search(const CheckOptions& options, Stopwatch& watch) {
  CheckedSurface first = read_checked_surface(options.mesh, options.end_mesh, options.weld, watch);
  CollisionRequest request;
  request.method = options.method;
  request.thickness = options.thickness.value_or(0);
  request.adjacent = options.adjacent;
  request.segments = options.segments;
  request.filters.neighbour_rings = options.rings;
  if (!options.groups.empty()) request.filters.groups = read_groups(options.groups, first);
  std::optional<CheckedSurface> second;
  if (!options.against.empty()) {
    Stopwatch unused;
    second = read_checked_surface(options.against, "", options.weld, unused);
    watch.lap("against");
  }
  ProgressBar bar("collisions", options.common.quiet);
  request.on_progress = [&](std::string_view phase, double share) { bar.show(share, phase); };
  return find_collisions(std::move(first), std::move(second), options.end_mesh, std::move(request), watch);
}

int run_check(const CheckOptions& options) {
  Stopwatch watch;
  take_large_pages();
  check_options(options);
  OutputFiles outputs;
  expect_outputs(options, outputs);
  const CollisionReport report = search(options, watch);
  std::optional<Image> image;
  if (!options.picture.empty()) {
    image = draw_collisions(report);
    watch.lap("picture");
  }
  if (!options.common.json.empty()) outputs.write_text(options.common.json, print_json(report, watch));
  if (!options.vtu.empty())
    outputs.write_file(options.vtu, [&](const auto& path) { write_vtu(path, mark_collisions(report)); });
  if (!options.ply.empty()) {
    const ColouredSurface coloured = colour_collisions(report);
    outputs.write_file(options.ply, [&](const auto& path) {
      write_coloured_ply(path, coloured.mesh, coloured.vertices, coloured.triangles);
    });
  }
  if (image) outputs.write_file(options.picture, [&](const auto& path) { write_png(path, *image); });
  outputs.commit();
  watch.lap("write");
  if (!options.common.quiet && !outputs.uses_standard_output()) print_summary(report, watch);
  return report.is_clean() ? kDone : kCollisions;
}

void add_searches(CLI::App& app, CheckOptions& options) {
  app.add_option("--to", options.end_mesh,
                 "Find pairs (vertex and face, edge and edge) that meet while each vertex moves on a straight line "
                 "from MESH to MESH1, the same mesh in another pose")
      ->type_name("MESH1");
  app.add_option("--against", options.against,
                 "Find pairs between MESH and another mesh, as of a garment and a body, and none within either; with "
                 "--to this one stands still")
      ->type_name("B");
  app.add_option("--thickness", options.thickness,
                 "Find also what is nearer than that without meeting: a vertex and a face, two edges, with their "
                 "distances; during a step what comes nearer [m]")
      ->type_name("T");
  app.add_option("--groups", options.groups,
                 "Leave out pairs within a group: pieces (those that hang together), names (objects and groups of an "
                 ".obj), or a file with a whole number for each face, one a line, -1: in no group")
      ->type_name("HOW");
  app.add_option("--rings", options.rings, "Leave out pairs that a path of N edges or fewer joins")
      ->check(CLI::Range(0, 1000))
      ->type_name("N");
  app.add_flag("--weld", options.weld,
               "Join vertices that are in one place, as of an STL file, where no triangles share any");
  app.add_flag("--adjacent", options.adjacent,
               "Find also the pairs of triangles that share a vertex or an edge and meet anywhere else");
  app.add_option(
         "--method", options.method,
         fmt::format("How pairs are culled: {}. dual-cone, dual-cone-internal and "
                     "enhanced-dual-cone-published follow their papers and may miss pairs; all others find every pair",
                     fmt::join(culling_method_names(), ", ")))
      ->type_name("NAME");
}

}  // namespace

Command add_check(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* sub =
      add_subcommand(app, "check",
                     "Finds the self-collisions of a surface, or of the boundary of a tetrahedral mesh: all "
                     "pairs of triangles that meet, exactly. Exit status 1 if there are any.",
                     kCheckExample);
  sub->add_option("mesh", options->mesh, "Mesh file")->required()->type_name("MESH");
  add_searches(*sub, *options);
  sub->add_flag("--segments", options->segments,
                "With --json: write also the segment in which the two triangles of each pair meet, by its ends");
  sub->add_option("--vtu", options->vtu, "Write the surface with the colliding triangles marked, for ParaView")
      ->type_name("FILE.vtu");
  sub->add_option("--ply", options->ply, "Write the surface with what collides in colours, for Blender or MeshLab")
      ->type_name("FILE.ply");
  sub->add_option("--picture", options->picture, "Draw the surface with what collides in colour")
      ->type_name("FILE.png");
  return {sub, &options->common, [options] { return run_check(*options); }};
}

}  // namespace selvage::cli
