#include "core/isa.h"
#include "peer/collisions/self_collision.h"
#include "peer/paths/boundary_path.h"
#include "peer/paths/tangled_meshes.h"
#include "peer/simulation.h"
#include "selvage/core/error.h"
#include "selvage/self_collision/self_collision.h"
#include "selvage/shapes/sequences.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <thread>

namespace {

using namespace selvage;
using namespace selvage::bench;

struct Arguments {
  std::vector<std::string> meshes, shapes;
  std::vector<std::int64_t> elements{13'000, 100'000, 1'000'000};
  int threads = static_cast<int>(std::thread::hardware_concurrency());
  std::string json;
  bool quick = false;

  /// One thread, then all.
  std::vector<int> thread_counts() const { return threads > 1 ? std::vector{1, threads} : std::vector{1}; }
  std::FILE* table() const { return json == "-" ? stderr : stdout; }
};

std::string short_count(std::int64_t n) {
  return n >= 1'000'000 ? fmt::format("{:.3g}M", n * 1e-6) : fmt::format("{:.3g}k", n * 1e-3);
}

void bench_boundary_path(const Arguments& arguments) {
  BoundaryPathPlan plan;
  plan.threads = arguments.thread_counts();
  if (arguments.quick) {
    plan.seconds = 0.2;
    plan.fewest_rounds = 3;
    plan.most_queries = 5000;
  }
  Report report(arguments.table());
  report.say(
      fmt::format("boundary-path: the library ({} kernels) beside the method of SPB on Embree 3; ratios are "
                  "medians over rounds, peer / ours",
                  isa_name(active_isa())));
  for (const std::string& path : arguments.meshes)
    measure_boundary_paths(std::filesystem::path(path).stem().string(), read_mesh(path), plan, report);
  for (std::int64_t elements : arguments.elements) {
    if (!arguments.meshes.empty() && arguments.shapes.empty()) break;
    if (arguments.quick && elements != arguments.elements.front()) break;
    for (const TangledShape& shape : tangled_shapes()) {
      const auto& wanted = arguments.shapes;
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), shape.name) == wanted.end()) continue;
      const IndexedMesh mesh = make_tangled(shape, elements);
      const std::int64_t count = std::ssize(mesh.tetrahedra);
      const std::string name = fmt::format("{}-{}", shape.name, short_count(count));
      if (count > 2 * elements)
        report.say(fmt::format("\n{} left out: it cannot be made of {} tets", name, short_count(elements)));
      else
        measure_boundary_paths(name, mesh, plan, report);
    }
  }
  if (!arguments.json.empty()) report.write_json(arguments.json);
}

struct CollisionArguments {
  std::vector<std::string> sequences, runs, methods;
  int frames = 24;
  std::int64_t triangles = 0;
  bool without_peers = false, without_steps = false, without_growth = false;
};

void bench_self_collision(const Arguments& arguments, const CollisionArguments& collision) {
  const SelfCollisionPlan plan{arguments.thread_counts(), collision.methods, !collision.without_peers,
                               !collision.without_steps};
  const int frames = arguments.quick ? 4 : collision.frames;
  CollisionReport report(arguments.table());
  report.say(
      fmt::format("self-collision: the library ({} kernels) beside CGAL and Embree 3; a frame is a new pose, "
                  "refit and all pairs; ratios are medians over frames, peer / ours",
                  isa_name(active_isa())));
  for (const std::string& path : arguments.meshes)
    measure_self_collision({std::filesystem::path(path).stem().string(), read_mesh(path), 6}, plan, report);
  for (const std::string& folder : collision.runs)
    measure_self_collision(CollisionSubject(std::filesystem::path(folder), frames), plan, report);
  const auto& wanted = collision.sequences;
  const bool has_own = !arguments.meshes.empty() || !collision.runs.empty();
  for (const std::string_view name : sequence_names()) {
    if (wanted.empty() ? has_own : std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    measure_self_collision({name, arguments.quick ? 10'000 : collision.triangles, frames}, plan, report);
  }
  if (wanted.empty() && !has_own && !arguments.quick) measure_self_collision({"crumple", 1'000'000, 4}, plan, report);
  report.print_tables();
  if (!collision.without_growth) {
    std::vector<std::int64_t> sizes{16'000, 64'000, 250'000, 1'000'000};
    if (arguments.quick) sizes.resize(2);
    measure_growth(sizes, std::min(frames, 8), report);
  }
  if (!arguments.json.empty()) report.write_json(arguments.json);
}

void bench_simulation(const Arguments& arguments, SimulationPlan plan) {
  if (arguments.quick) {
    plan.frames = 2;
    plan.scenes = {"sliding_cube", "tangled_noodle", "octopi_8_hybrid"};
    plan.growth = false;
  }
  plan.threads = arguments.threads;
  measure_simulation(plan, arguments.table(), arguments.json);
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("The measurements behind the figures in the docs.");
  app.require_subcommand(1);
  CLI::App* list = app.add_subcommand("list", "Names of the benchmarks");
  Arguments arguments;
  CLI::App* paths = app.add_subcommand("boundary-path", "Shortest paths to the boundary, beside SPB on Embree 3");
  paths->footer("Example: selvage_bench boundary-path --quick --mesh tangled.t --json result.json");
  paths->add_option("--mesh", arguments.meshes, "Tangled tetrahedral meshes instead of the ones made by formula")
      ->check(CLI::ExistingFile);
  paths->add_option("--shape", arguments.shapes, "Only these: octopus, squishy-balls, rod, beam, aligned-rod");
  paths->add_option("--elements", arguments.elements, "Sizes of the meshes made by formula");
  CollisionArguments collision;
  CLI::App* collisions = app.add_subcommand("self-collision", "Self-collisions of surfaces, beside CGAL and Embree 3");
  collisions->footer("Example: selvage_bench self-collision --quick --sequence pipe --json result.json");
  collisions->add_option("--mesh", arguments.meshes, "Meshes instead of the sequences made by formula")
      ->check(CLI::ExistingFile);
  collisions->add_option("--run", collision.runs, "Frames of simulated runs instead: their folders")
      ->check(CLI::ExistingDirectory);
  collisions->add_option("--sequence", collision.sequences,
                         fmt::format("Only these: {}", fmt::join(sequence_names(), ", ")));
  collisions->add_option("--triangles", collision.triangles, "About how many each; 0: as many as it has")
      ->check(CLI::NonNegativeNumber);
  collisions->add_option("--method", collision.methods, "Only these culling methods")
      ->check(CLI::IsMember(std::vector<std::string>(culling_method_names().begin(), culling_method_names().end())));
  collisions->add_option("--frames", collision.frames, "Frames of each sequence, or as many as it has")
      ->check(CLI::Range(2, 100'000));
  collisions->add_flag("--no-peers", collision.without_peers, "The library alone");
  collisions->add_flag("--no-steps", collision.without_steps, "Discrete queries alone");
  collisions->add_flag("--no-growth", collision.without_growth, "Without the time against size");
  SimulationPlan simulation;
  simulation.folder = SELVAGE_SCENES;
  CLI::App* scenes = app.add_subcommand("simulation", "Scenes, with the columns of SPB table 1");
  scenes->footer("Example: selvage_bench simulation --scene octopi_8_hybrid --frames 30");
  scenes->add_option("--scenes", simulation.folder, "Folder of the scenes")->capture_default_str();
  scenes->add_option("--scene", simulation.scenes, "Only these");
  scenes->add_option("--scale", simulation.scale, "A scale of theirs, as paper; an empty text: as they stand")
      ->capture_default_str();
  scenes->add_option("--frames", simulation.frames, "Frames of each; without, as many as it has")
      ->check(CLI::PositiveNumber);
  scenes->add_flag("!--culling-only", simulation.without_culling, "Not also without infeasible-region culling");
  scenes->add_flag("!--no-growth", simulation.growth, "Without the cost of a step over 1, 10 and 100 octopi");
  for (CLI::App* sub : {paths, collisions, scenes}) {
    sub->add_option("--threads", arguments.threads, "All threads; 1: nothing but one")->check(CLI::PositiveNumber);
    sub->add_option("--json", arguments.json, "Machine-readable result; - is standard output");
    sub->add_flag("--quick", arguments.quick, "The smallest meshes, little work, few rounds");
  }
  CLI11_PARSE(app, argc, argv);
  if (*list) fmt::print("boundary-path\nself-collision\nsimulation\n");
  if (*paths) bench_boundary_path(arguments);
  if (*collisions) bench_self_collision(arguments, collision);
  if (*scenes) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(arguments.threads));
    bench_simulation(arguments, simulation);
  }
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "selvage_bench: {}\n", error.what());
  return 2;
}
