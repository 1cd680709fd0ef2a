#include "peer/boundary_path.h"
#include "peer/tangled_meshes.h"
#include "selvage/core/error.h"
#include "selvage/core/isa.h"

#include <fmt/format.h>
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
};

std::string short_count(std::int64_t n) {
  return n >= 1'000'000 ? fmt::format("{:.3g}M", n * 1e-6) : fmt::format("{:.3g}k", n * 1e-3);
}

void bench_boundary_path(const Arguments& arguments) {
  BoundaryPathPlan plan;
  plan.threads = {1};
  if (arguments.threads > 1) plan.threads.push_back(arguments.threads);
  if (arguments.quick) {
    plan.seconds = 0.2;
    plan.fewest_rounds = 3;
    plan.most_queries = 5000;
  }
  Report report(arguments.json == "-" ? stderr : stdout);
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
      const MeshFile mesh = make_tangled(shape, elements);
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
  paths->add_option("--threads", arguments.threads, "All threads; 1: nothing but one")->check(CLI::PositiveNumber);
  paths->add_option("--json", arguments.json, "Machine-readable result; - is standard output");
  paths->add_flag("--quick", arguments.quick, "The smallest meshes, few queries, few rounds");
  CLI11_PARSE(app, argc, argv);
  if (*list) fmt::print("boundary-path\n");
  if (*paths) bench_boundary_path(arguments);
  return 0;
} catch (const std::exception& error) {
  fmt::print(stderr, "selvage_bench: {}\n", error.what());
  return 2;
}
