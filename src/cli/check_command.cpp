#include "cli/collision_report.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/output.h"
#include "selvage/core/error.h"
#include "selvage/mesh/simplex_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>

namespace selvage::cli {

namespace {

struct CheckOptions {
  CommonOptions common;
  std::string mesh, method = "auto", vtu;
  bool adjacent = false;
};

constexpr const char* kExample =
    "  selvage check shirt.obj\n"
    "  selvage check octopus.t --adjacent --json pairs.json --vtu octopus.vtu\n"
    "Exit status 1: there are collisions. In JSON, `triangle_pairs` are pairs of numbers of triangles, from 0, in the\n"
    "order of the file; of a tetrahedral mesh, in the order of `triangles`, which lists their vertices. `contacts` "
    "says\n"
    "of each pair whether it is crossing, touching or a coplanar overlap. The .vtu file holds the surface with the\n"
    "number of each triangle's pairs in `collisions`.";

/// The triangles that are checked: a surface's own, or the boundary of a tetrahedral mesh.
std::vector<VertexTuple<3>> surface_of(const MeshFile& file) {
  if (file.tetrahedra.empty()) return file.triangles;
  const TetMesh mesh(static_cast<Index>(file.positions.size()), file.tetrahedra);
  return {mesh.boundary_faces().begin(), mesh.boundary_faces().end()};
}

CollisionReport find_collisions(const CheckOptions& options, const MeshFile& file, Stopwatch& watch) {
  CollisionReport report;
  report.mesh = options.mesh;
  report.method = options.method;
  report.solid = !file.tetrahedra.empty();
  report.positions = file.positions;
  report.triangles = surface_of(file);
  const TriangleMesh mesh(static_cast<Index>(file.positions.size()), report.triangles);
  watch.lap("topology");
  SelfCollisionOptions asked;
  asked.method = culling_method(options.method);
  asked.include_adjacent = options.adjacent;
  const SelfCollisionFinder finder(mesh, file.positions, std::move(asked));
  watch.lap("hierarchy");
  ProgressBar bar("collisions", options.common.quiet);
  bar.show(0);
  report.pairs = finder.find_pairs(&report.counters);
  watch.lap("pairs");
  return report;
}

int run_check(const CheckOptions& options) {
  Stopwatch watch;
  culling_method(options.method);
  OutputFiles outputs;
  outputs.expect(options.common.json, files_of_mesh(options.mesh));
  outputs.expect(options.vtu, files_of_mesh(options.mesh));
  if (!options.vtu.empty() && std::filesystem::path(options.vtu).extension() != ".vtu")
    throw Error(options.vtu, "--vtu writes .vtu files only", "give it that extension");
  const MeshFile file = read_mesh(options.mesh);
  watch.lap("read");
  const CollisionReport report = find_collisions(options, file, watch);
  if (!options.common.json.empty()) outputs.write_text(options.common.json, print_json(report, watch));
  if (!options.vtu.empty())
    outputs.write_file(options.vtu, [&](const auto& path) { write_vtu(path, mark_collisions(report)); });
  outputs.commit();
  watch.lap("write");
  if (!options.common.quiet && !outputs.uses_standard_output()) print_summary(report, watch);
  return report.pairs.empty() ? kDone : kCollisions;
}

}  // namespace

Command add_check(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* sub =
      add_subcommand(app, "check",
                     "Finds the self-collisions of a surface, or of the boundary of a tetrahedral mesh: all "
                     "pairs of triangles that meet, exactly. Exit status 1: there are some.",
                     kExample, options->common);
  sub->add_option("mesh", options->mesh, "Mesh file")->required()->type_name("MESH");
  sub->add_option(
         "--method", options->method,
         fmt::format("How pairs are culled: {}. All but three give every pair; for comparison, dual-cone, "
                     "dual-cone-internal and enhanced-dual-cone-published are as in their papers and may miss some",
                     fmt::join(culling_method_names(), ", ")))
      ->type_name("NAME");
  sub->add_flag("--adjacent", options->adjacent,
                "Also triangles that share a vertex or an edge and meet anywhere else");
  sub->add_option("--vtu", options->vtu, "Write the surface with the colliding triangles marked, for ParaView")
      ->type_name("FILE.vtu");
  return {sub, &options->common, [options] { return run_check(*options); }};
}

}  // namespace selvage::cli
