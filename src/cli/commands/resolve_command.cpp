#include "cli/arguments/vertex_list.h"
#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/json_text.h"
#include "cli/program/output.h"
#include "selvage/core/error.h"
#include "selvage/io/mesh_file.h"
#include "selvage/mesh/triangle_mesh.h"
#include "selvage/untangling/resolve.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

namespace selvage::cli {

namespace {

struct ResolveCommandOptions {
  CommonOptions common;
  std::string mesh, rest, output, pin;
  bool to_rest = false;
  std::vector<double> pin_box;
  ResolveOptions limits;
};

constexpr const char* kResolveExample =
    "  selvage make rod --length 8 --radius 0.2 --pose self-crossing -o tangled.vtu\n"
    "  selvage resolve tangled.vtu -o resolved.vtu --json report.json\n"
    "  selvage make rod --length 8 --radius 0.2 -o rest.vtu\n"
    "  selvage resolve tangled.vtu --rest rest.vtu -o surface.obj\n"
    "\n"
    "Vertices far from any tangle keep their coordinates. Where the mesh cannot be resolved the exit status is 3, and "
    "no mesh is written; the report lists the elements that are in the way. See docs/guides/resolve.md.";

constexpr std::size_t kListed = 8;

IndexedMesh read_solid(const std::string& path) {
  IndexedMesh mesh = read_mesh(path);
  if (mesh.tetrahedra.empty()) throw Error(path, "there is no tetrahedron", "give a mesh of tetrahedra");
  return mesh;
}

/// What a format of surfaces holds of the mesh.
IndexedMesh boundary_of(const IndexedMesh& mesh) {
  return boundary_mesh(TetMesh(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra), mesh.positions);
}

std::vector<Vec3> read_rest(const std::string& path, const IndexedMesh& mesh) {
  IndexedMesh rest = read_solid(path);
  if (rest.positions.size() != mesh.positions.size() || rest.tetrahedra != mesh.tetrahedra)
    throw Error(path, "differs from the mesh in its vertices or elements", "give the same mesh in another pose");
  return std::move(rest.positions);
}

std::vector<Index> find_pinned(const ResolveCommandOptions& options, const IndexedMesh& mesh) {
  const auto count = static_cast<Index>(mesh.positions.size());
  std::vector<Index> pinned;
  if (!options.pin.empty()) pinned = read_vertices(options.pin, count);
  if (options.pin_box.empty()) return pinned;
  const Vec3 a(options.pin_box.data()), b(options.pin_box.data() + 3);
  const std::size_t before = pinned.size();
  for (Index v = 0; v < count; ++v) {
    const Vec3& p = mesh.positions[v];
    if ((p.array() >= a.cwiseMin(b).array()).all() && (p.array() <= a.cwiseMax(b).array()).all()) pinned.push_back(v);
  }
  if (pinned.size() == before) throw Error("--pin-box", "contains no vertex", "`selvage info` prints the bounding box");
  return pinned;
}

std::string_view name_of(ResolveOutcome outcome) {
  switch (outcome) {
    case ResolveOutcome::kResolved:
      return "resolved";
    case ResolveOutcome::kStuck:
      return "stuck";
    case ResolveOutcome::kHeld:
      return "held";
    default:
      return "gave up";
  }
}

nlohmann::ordered_json json_of(const ResolveIteration& row) {
  return {{"iteration", row.iteration},
          {"triangle_pairs", row.triangle_pairs},
          {"penetrating_vertices", row.penetrating_vertices},
          {"penetrating_edges", row.penetrating_edges},
          {"penetrating_centroids", row.penetrating_centroids},
          {"blocked_points", row.blocked_points},
          {"waiting_points", row.waiting_points},
          {"inverted_elements", row.inverted_elements},
          {"deepest", row.deepest},
          {"total_depth", row.total_depth},
          {"awake_vertices", row.awake_vertices},
          {"max_displacement", row.max_displacement}};
}

nlohmann::ordered_json json_of(const ResolveCommandOptions& options, const ResolveReport& report,
                               const Stopwatch& watch) {
  nlohmann::ordered_json json{
      {"schema", 1},
      {"kind", "resolve"},
      {"mesh", options.mesh},
      {"outcome", name_of(report.outcome)},
      {"before", json_of(report.iterations.front())},
      {"after", json_of(report.iterations.back())},
      {"displacement",
       {{"moved_vertices", report.moved_vertices},
        {"max", report.max_displacement},
        {"mean", report.mean_displacement}}},
      {"volume",
       {{"at_rest", report.volume_at_rest}, {"before", report.volume_before}, {"after", report.volume_after}}},
      {"elastic_energy", {{"before", report.elastic_energy_before}, {"after", report.elastic_energy_after}}},
      {"pinned_vertices", options.limits.pinned.size()},
      {"tangled_elements", report.tangled_elements},
      {"holding_vertices", report.holding_vertices}};
  if (report.outcome == ResolveOutcome::kResolved) json["output"] = options.output;
  for (const ResolveIteration& row : report.iterations) json["iterations"].push_back(json_of(row));
  for (const auto& [phase, seconds] : watch.laps()) json["seconds"][phase] = seconds;
  return json;
}

std::string penetrations(const ResolveIteration& row) {
  std::string text = fmt::format("{} vertices, {} edges, {} centroids", grouped(row.penetrating_vertices),
                                 grouped(row.penetrating_edges), grouped(row.penetrating_centroids));
  if (row.waiting_points > 0) text += fmt::format(", {} points at inverted elements", grouped(row.waiting_points));
  return text;
}

void print_summary(const ResolveCommandOptions& options, const ResolveReport& report, double seconds) {
  const ResolveIteration &before = report.iterations.front(), &after = report.iterations.back();
  const auto change = [](double from, double to) { return 100 * (to - from) / std::abs(from); };
  Table table;
  table.add("mesh", options.mesh);
  table.add("outcome", fmt::format("{} after {} {}", name_of(report.outcome), after.iteration,
                                   after.iteration == 1 ? "iteration" : "iterations"));
  table.add("triangle pairs",
            fmt::format("{} before, {} after", grouped(before.triangle_pairs), grouped(after.triangle_pairs)));
  table.add("inside before", penetrations(before));
  table.add("inside after", penetrations(after));
  table.add("inverted elements",
            fmt::format("{} before, {} after", grouped(before.inverted_elements), grouped(after.inverted_elements)));
  table.add("moved", fmt::format("{} vertices, at most {:.3g} m, on average {:.3g} m", grouped(report.moved_vertices),
                                 report.max_displacement, report.mean_displacement));
  // Before, inverted elements count as negative: with them only the rest tells how much there should be. But a pose
  // that is kept may have more or less of it.
  std::string volume = fmt::format("{:.6g} m^3, ", report.volume_after);
  if (!options.rest.empty())
    volume += fmt::format("{:+.2g}% beside the rest, ", change(report.volume_at_rest, report.volume_after));
  volume += fmt::format("{:+.2g}% beside the mesh before", change(report.volume_before, report.volume_after));
  table.add("volume", volume);
  table.add("elastic energy", fmt::format("{:.3g} J before, {:.3g} J after, for a Young's modulus of 1 Pa",
                                          report.elastic_energy_before, report.elastic_energy_after));
  table.add("time", readable_duration(seconds));
  table.print();
}

/// The first of them.
std::string listed(std::span<const Index> numbers) {
  const auto shown = numbers.first(std::min(numbers.size(), kListed));
  return fmt::format("{}{}", fmt::join(shown, " "), shown.size() < numbers.size() ? " ..." : "");
}

/// One line that says what is in the way.
std::string failure_of(const ResolveCommandOptions& options, const ResolveReport& report) {
  const auto &elements = report.tangled_elements, &pinned = report.holding_vertices;
  if (report.outcome == ResolveOutcome::kHeld)
    return fmt::format(
        "{}: cannot be resolved with these pins: pinned parts collide or are inverted, at {} elements: {}; pin "
        "fewer vertices",
        options.mesh, elements.size(), listed(elements));
  const ResolveIteration& last = report.iterations.back();
  const std::string pins =
      pinned.empty() ? "" : fmt::format("; {} pinned vertices are in it: {}", pinned.size(), listed(pinned));
  return fmt::format("{}: {} after {} {}, with {} pairs of triangles and {} left; {} elements in the way: {}{}",
                     options.mesh, report.outcome == ResolveOutcome::kStuck ? "is stuck" : "is not resolved",
                     last.iteration, last.iteration == 1 ? "iteration" : "iterations", last.triangle_pairs,
                     penetrations(last), elements.size(), listed(elements), pins);
}

ResolveReport resolve(ResolveCommandOptions& options, IndexedMesh& mesh) {
  ProgressBar progress("resolve", options.common.quiet);
  double first = 0;
  options.limits.on_iteration = [&](const ResolveIteration& row) {
    if (row.iteration == 0) first = row.total_depth;
    progress.show(first > 0 ? std::clamp(1 - row.total_depth / first, 0.0, 1.0) : 1,
                  fmt::format("iteration {}: {} pairs, {} inside, deepest {:.2g} m", row.iteration,
                              grouped(row.triangle_pairs), grouped(row.penetrating_vertices), row.deepest));
  };
  const TetMesh topology(static_cast<Index>(mesh.positions.size()), mesh.tetrahedra);
  ResolveReport report = resolve_collisions(topology, mesh.positions, options.limits);
  progress.clear();
  return report;
}

void run_resolve(ResolveCommandOptions& options) {
  Stopwatch watch;
  std::vector<std::filesystem::path> inputs = files_of_mesh(options.mesh);
  for (const std::string& input : {options.rest, options.pin})
    if (!input.empty()) inputs.emplace_back(input);
  OutputFiles outputs;
  if (options.output == "-") throw Error("-o", "a mesh cannot be written to standard output", "name a file");
  for (const auto& file : files_of_mesh(options.output)) outputs.expect(file.string(), inputs);
  outputs.expect(options.common.json, inputs);

  if (!(options.limits.max_displacement > 0))
    throw Error("--max-displacement", fmt::format("is {}", options.limits.max_displacement), "give a length above 0");
  if (!(options.limits.clearance > 0 && options.limits.clearance < 1))
    throw Error("--clearance", fmt::format("is {}", options.limits.clearance), "give a number between 0 and 1");

  if (options.to_rest && options.rest.empty())
    throw Error("--to-rest", "has no effect without a rest", "add --rest MESH");
  options.limits.keep_pose = !options.rest.empty() && !options.to_rest;
  const bool as_surface = !holds_tetrahedra(options.output);

  IndexedMesh mesh = read_solid(options.mesh);
  if (!as_surface) check_format_holds(options.output, mesh);
  if (!options.rest.empty()) options.limits.rest_positions = read_rest(options.rest, mesh);
  options.limits.pinned = find_pinned(options, mesh);
  watch.lap("read");
  const ResolveReport report = resolve(options, mesh);
  watch.lap("resolve");
  const bool resolved = report.outcome == ResolveOutcome::kResolved;
  if (resolved) outputs.write_mesh(options.output, as_surface ? boundary_of(mesh) : mesh);
  watch.lap("write");
  outputs.write_text(options.common.json, json_text(json_of(options, report, watch)) + "\n");
  outputs.commit();
  if (!resolved) throw Failure(failure_of(options, report));
  if (!options.common.quiet && !outputs.uses_standard_output()) print_summary(options, report, watch.total());
}

}  // namespace

Command add_resolve(CLI::App& app) {
  auto options = std::make_shared<ResolveCommandOptions>();
  CLI::App* sub =
      add_subcommand(app, "resolve",
                     "Moves a tangled tetrahedral mesh until nothing meets. Parts that are not tangled keep "
                     "their shape.",
                     kResolveExample);
  sub->add_option("mesh", options->mesh, "Mesh file")->required()->type_name("MESH");
  sub->add_option("-o,--output", options->output,
                  "Mesh file to write; its extension tells the format: of the boundary, where it holds surfaces only")
      ->required()
      ->type_name("OUT");
  sub->add_option("--rest", options->rest,
                  "The same mesh in its stress-free shape, which it takes near the tangle, and keeps its pose "
                  "elsewhere; without this option, MESH itself")
      ->type_name("MESH");
  sub->add_flag("--to-rest", options->to_rest, "Draw the whole mesh towards --rest, and give up its pose");
  sub->add_option("--pin", options->pin, "Vertices that must not move: one number a line")->type_name("FILE");
  sub->add_option("--pin-box", options->pin_box, "Two corners of a box whose vertices must not move [m]")
      ->expected(6)
      ->type_name("X Y Z X Y Z");
  sub->add_option("--max-displacement", options->limits.max_displacement,
                  "Largest distance of a vertex from its start [m]")
      ->type_name("D");
  sub->add_option("--clearance", options->limits.clearance,
                  "Smallest distance between surfaces that met, in mean edge lengths of the boundary (0.05)")
      ->type_name("C");
  sub->add_option("--iterations", options->limits.max_iterations, "Largest number of iterations (2000)")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  sub->add_option("--patience", options->limits.patience,
                  "Iterations without progress after which the mesh counts as stuck (60)")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  return {sub, &options->common, [options] {
            run_resolve(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
