#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/memory.h"
#include "cli/program/output.h"
#include "cli/reports/collision_report.h"
#include "core/parallel.h"
#include "selvage/core/error.h"
#include "selvage/io/vtu.h"
#include "selvage/mesh/simplex_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <memory>

namespace selvage::cli {

namespace {

struct CheckOptions {
  CommonOptions common;
  std::string mesh, end_mesh, method = "auto", vtu;
  bool adjacent = false, segments = false;
};

constexpr const char* kCheckExample =
    "  selvage make rod -o rod.vtu\n"
    "  selvage make rod --pose self-crossing -o bent.vtu\n"
    "  selvage check bent.vtu --adjacent --json pairs.json --vtu marked.vtu\n"
    "  selvage check rod.vtu --to bent.vtu\n"
    "\n"
    "Exit status: 0 no collision, 1 collisions, 2 bad usage or bad input, 3 the computation failed.\n"
    "\n"
    "In JSON, `triangle_pairs` are pairs of triangle numbers, from 0, in the order of the file; of a tetrahedral "
    "mesh, in the order of `triangles`, which lists their vertices. `contacts` gives the kind of each pair: "
    "crossing, touching or a coplanar overlap. With --segments, `segments` has for each pair the ends of what both "
    "triangles have in common, or null where they overlap in one plane. With --to, `vertex_face` are pairs of a vertex "
    "and a triangle, `edge_edge` the vertices of two edges, and `free_step` is the largest fraction of the step "
    "without collisions. The .vtu file holds the surface with the number of each triangle's pairs in `collisions`.";

/// The triangles that are checked: a surface's own, or the boundary of a tetrahedral mesh.
TriangleMesh surface_of(IndexedMesh& file) {
  const auto vertex_count = static_cast<Index>(file.positions.size());
  if (file.tetrahedra.empty()) return {vertex_count, std::move(file.triangles)};
  return boundary_surface(TetMesh(vertex_count, std::move(file.tetrahedra)));
}

/// Reads the mesh, and with `--to` beside it the positions at the end of the step: of a mesh that is the same but for
/// them.
std::pair<IndexedMesh, std::vector<Vec3>> read_poses(const CheckOptions& options) {
  IndexedMesh start, end;
  if (options.end_mesh.empty()) return {read_mesh(options.mesh), {}};
  std::exception_ptr wrong_with_end;  // said only where nothing is wrong with the start
  parallel_invoke([&] { start = read_mesh(options.mesh); },
                  [&] {
                    try {
                      end = read_mesh(options.end_mesh);
                    } catch (...) {
                      wrong_with_end = std::current_exception();
                    }
                  });
  if (wrong_with_end) std::rethrow_exception(wrong_with_end);
  if (end.positions.size() != start.positions.size())
    throw Error(
        options.end_mesh,
        fmt::format("has {} vertices, and {} has {}", end.positions.size(), options.mesh, start.positions.size()),
        "give two poses of one mesh");
  if (end.triangles != start.triangles || end.tetrahedra != start.tetrahedra)
    throw Error(options.end_mesh, fmt::format("has other elements than {}", options.mesh),
                "give two poses of one mesh");
  return {std::move(start), std::move(end.positions)};
}

/// Shows how far each phase of a check has come.
class CheckProgress {
 public:
  explicit CheckProgress(bool quiet) : bar_("collisions", quiet) {}

  /// @param from, to  the phase's part of the bar
  void begin(std::string_view phase, double from, double to) {
    phase_ = phase;
    from_ = from;
    to_ = to;
    show(0);
  }
  void show(double share) { bar_.show(from_ + share * (to_ - from_), phase_); }

 private:
  ProgressBar bar_;
  std::string_view phase_ = "hierarchy";
  double from_ = 0, to_ = 0;
};

CollisionReport find_collisions(const CheckOptions& options, IndexedMesh file, std::span<const Vec3> end,
                                Stopwatch& watch) {
  CollisionReport report;
  report.mesh = options.mesh;
  report.end_mesh = options.end_mesh;
  report.method = options.method;
  report.has_segments = options.segments;
  report.solid = !file.tetrahedra.empty();
  report.surface = surface_of(file);
  report.positions = std::move(file.positions);
  watch.lap("topology");
  SelfCollisionOptions asked;
  asked.method = culling_method(options.method);
  // One pose is compared in less time than it takes to find out where there is no need to.
  if (asked.method == CullingMethod::kAuto && options.end_mesh.empty()) asked.method = CullingMethod::kBvh;
  asked.asked_once = true;
  asked.include_adjacent = options.adjacent;
  CheckProgress progress(options.common.quiet);
  asked.on_progress = [&](double share) { progress.show(share); };
  if (options.end_mesh.empty()) {
    const SelfCollisionFinder finder(report.surface, report.positions, std::move(asked));
    watch.lap("hierarchy");
    progress.begin("looking for pairs", 0.3, options.segments ? 0.8 : 1);
    report.pairs = finder.find_pairs(&report.counters);
    watch.lap("pairs");
    if (options.segments) {
      progress.begin("segments", 0.8, 1);
      report.segments = finder.find_segments(report.pairs);
      watch.lap("segments");
    }
    return report;
  }
  const ContinuousCollisionFinder finder(report.surface, report.positions, end, std::move(asked));
  watch.lap("hierarchy");
  progress.begin("looking for pairs", 0.2, 0.8);
  report.moving_pairs = finder.find_pairs(&report.moving_counters);
  watch.lap("pairs");
  progress.begin("times of impact", 0.8, 1);
  report.free_step = finder.find_free_step(report.moving_pairs);
  watch.lap("impact");
  return report;
}

int run_check(const CheckOptions& options) {
  Stopwatch watch;
  take_large_pages();
  culling_method(options.method);
  OutputFiles outputs;
  std::vector<std::filesystem::path> inputs = files_of_mesh(options.mesh);
  if (!options.end_mesh.empty())
    for (const auto& path : files_of_mesh(options.end_mesh)) inputs.push_back(path);
  outputs.expect(options.common.json, inputs);
  outputs.expect(options.vtu, inputs);
  if (options.adjacent && !options.end_mesh.empty())
    throw Error("--adjacent", "does not apply to a step", "leave out --adjacent or --to");
  if (options.segments && !options.end_mesh.empty())
    throw Error("--segments", "does not apply to a step", "leave out --segments or --to");
  if (options.segments && options.common.json.empty())
    throw Error("--segments", "has no effect without --json", "add --json FILE");
  if (!options.vtu.empty() && std::filesystem::path(options.vtu).extension() != ".vtu")
    throw Error(options.vtu, "--vtu writes .vtu files only", "give it that extension");
  auto [file, end] = read_poses(options);
  watch.lap("read");
  const CollisionReport report = find_collisions(options, std::move(file), end, watch);
  if (!options.common.json.empty()) outputs.write_text(options.common.json, print_json(report, watch));
  if (!options.vtu.empty())
    outputs.write_file(options.vtu, [&](const auto& path) { write_vtu(path, mark_collisions(report)); });
  outputs.commit();
  watch.lap("write");
  if (!options.common.quiet && !outputs.uses_standard_output()) print_summary(report, watch);
  return report.is_clean() ? kDone : kCollisions;
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
  sub->add_option("--to", options->end_mesh,
                  "Find pairs (vertex and face, edge and edge) that meet while each vertex moves on a straight line "
                  "from MESH to MESH1, the same mesh in another pose")
      ->type_name("MESH1");
  sub->add_option(
         "--method", options->method,
         fmt::format("How pairs are culled: {}. dual-cone, dual-cone-internal and "
                     "enhanced-dual-cone-published follow their papers and may miss pairs; all others find every pair",
                     fmt::join(culling_method_names(), ", ")))
      ->type_name("NAME");
  sub->add_flag("--adjacent", options->adjacent,
                "Find also the pairs of triangles that share a vertex or an edge and meet anywhere else");
  sub->add_flag("--segments", options->segments,
                "With --json: write also the segment in which the two triangles of each pair meet, by its ends");
  sub->add_option("--vtu", options->vtu, "Write the surface with the colliding triangles marked, for ParaView")
      ->type_name("FILE.vtu");
  return {sub, &options->common, [options] { return run_check(*options); }};
}

}  // namespace selvage::cli
