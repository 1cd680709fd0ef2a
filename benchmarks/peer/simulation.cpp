#include "peer/simulation.h"

#include "peer/json_file.h"
#include "selvage/core/error.h"
#include "selvage/simulation/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

namespace selvage::bench {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::vector<std::string> names_of(const SimulationPlan& plan) {
  if (!plan.scenes.empty()) return plan.scenes;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(plan.folder)) names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Runs into a folder that is removed again.
json run(const Scene& scene, const SimulationPlan& plan) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("selvage-bench-{}", getpid());
  RunOptions options;
  options.folder = folder;
  if (plan.frames > 0) options.frames = plan.frames;
  const RunReport report = run_scene(scene, options);
  fs::remove_all(folder);
  return json::parse(summarize_run(scene, report));
}

void print_head(std::FILE* table) {
  fmt::print(table,
             "{:<26} {:>9} {:>10} {:>8} {:>8} {:>8} {:>7} {:>6} {:>6} {:>12} {:>8} {:>8} {:>6} {:>6} {:>6} {:>6}  {}\n",
             "scene", "vertices", "elements", "ccd", "dcd", "paths", "volumes", "trav.", "elem.", "step x iter",
             "avg s", "max s", "xpbd", "ccd", "dcd", "paths", "at the end");
}

void print_row(std::FILE* table, const std::string& name, const json& s) {
  const auto& step = s["average_per_step"];
  const auto& path = s["average_per_path"];
  const auto& share = s["shares"];
  const auto percent = [&](const char* part) { return 100 * share[part].get<double>(); };
  fmt::print(table,
             "{:<26} {:>9} {:>10} {:>8.1f} {:>8.1f} {:>8.1f} {:>7.1f} {:>6.2f} {:>6.2f} {:>12} {:>8.3f} {:>8.3f} "
             "{:>5.1f}% {:>5.1f}% {:>5.1f}% {:>5.1f}%  {} penetrate by {:.2g} m, {} inverted{}\n",
             name, s["vertices"].get<std::int64_t>(), s["elements"].get<std::int64_t>(),
             step["ccd_contacts"].get<double>(), step["dcd_contacts"].get<double>(), step["path_queries"].get<double>(),
             path["volumes"].get<double>(), path["traversals"].get<double>(), path["elements"].get<double>(),
             fmt::format("{:.1e} x {}", s["time_step"].get<double>(), s["iterations"].get<int>()),
             s["frame_seconds"]["average"].get<double>(), s["frame_seconds"]["longest"].get<double>(),
             percent("material"), percent("ccd"), percent("dcd"), percent("paths"),
             s["at_end"]["penetrating_vertices"].get<std::int64_t>(), s["at_end"]["deepest_penetration"].get<double>(),
             s["at_end"]["inverted_elements"].get<std::int64_t>(),
             s["outcome"] == "finished" ? "" : "; " + s["message"].get<std::string>());
  std::fflush(table);
}

}  // namespace

void measure_simulation(const SimulationPlan& plan, std::FILE* table, const std::string& json_path) {
  if (!fs::is_directory(plan.folder))
    throw Error(plan.folder.string(), "is no folder of scenes", "name it by --scenes");
  print_head(table);
  json results = json::array();
  for (const std::string& name : names_of(plan)) {
    Scene scene = read_scene(plan.folder / (name + ".json"), plan.scale);
    for (const bool culling : {true, false}) {
      if (!culling && !plan.without_culling) continue;
      scene.options.contact.cull_infeasible_regions = culling;
      json summary = run(scene, plan);
      summary["culling"] = culling;
      print_row(table, culling ? name : name + ", no culling", summary);
      results.push_back(std::move(summary));
    }
  }
  if (!json_path.empty()) write_json_file(json_path, {{"schema", 1}, {"kind", "bench-simulation"}, {"runs", results}});
}

}  // namespace selvage::bench
