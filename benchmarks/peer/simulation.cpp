#include "peer/simulation.h"

#include "material_limit.h"
#include "peer/json_file.h"
#include "selvage/core/error.h"
#include "selvage/scene/run.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <functional>

namespace selvage::bench {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kGrowing = "octopi_16.json";
constexpr std::int64_t kGrowthFrames = 10;
constexpr double kLargeMemory = 256 * 1024 * 1024;  ///< more than caches hold [bytes]

std::vector<std::string> names_of(const SimulationPlan& plan) {
  if (!plan.scenes.empty()) return plan.scenes;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(plan.folder))
    if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// A folder in the system's place for such, removed again with all that is in it.
class Folder {
 public:
  Folder() { fs::remove_all(path_); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_ = fs::temp_directory_path() / fmt::format("selvage-bench-{}", getpid());
};

/// The summary of a run, with what its material solve reached of the machine's limit. A machine's pace changes: the
/// limit is measured after every frame, of memory over as much as an iteration goes through, and a frame compared with
/// the mean of before and after. It is known of elements solved by XPBD alone: not with cloth, nor by other solvers.
json run(const Scene& scene, std::int64_t frames, int threads) {
  const Folder folder;
  RunOptions options;
  options.folder = folder.path();
  if (frames > 0) options.frames = frames;
  double bytes = 0;
  for (const Body& body : scene.model.bodies)
    bytes += material_bytes(body.element_count, body.vertex_count, body.material.damping > 0);
  LimitMeter meter(threads, bytes);
  std::vector<MachineLimit> limits;
  std::vector<double> handovers;
  options.on_frame = [&](const FrameStatistics&) {
    limits.push_back(meter.measure());
    if (threads > 1) handovers.push_back(measure_handover());
  };
  const RunReport report = run_scene(scene, options);
  json summary = json::parse(summarize_run(scene, report));
  double constraints = 0, seconds = 0, least = 0;
  for (std::size_t i = 1; i < report.frames.size(); ++i) {
    const FrameStatistics& row = report.frames[i];
    constraints += static_cast<double>(row.constraints);
    seconds += row.seconds_material;
    least += static_cast<double>(row.steps - report.frames[i - 1].steps) *
             limits[i - 1].mean_with(limits[i]).seconds(scene.model.bodies, scene.options.iterations);
  }
  const bool known = scene.solver == SolverKind::kXpbd &&
                     std::none_of(scene.model.bodies.begin(), scene.model.bodies.end(), std::mem_fn(&Body::is_cloth));
  if (seconds > 0 && known) {
    summary["constraints_per_second"] = constraints / seconds;
    summary["fraction_of_limit"] = least / seconds;
  }
  if (!handovers.empty()) {
    const auto middle = handovers.begin() + std::ssize(handovers) / 2;
    std::nth_element(handovers.begin(), middle, handovers.end());
    summary["handover_seconds"] = *middle;
  }
  return summary;
}

void print_head(std::FILE* table) {
  fmt::print(table,
             "{:<26} {:>9} {:>10} {:>8} {:>8} {:>8} {:>7} {:>6} {:>6} {:>12} {:>8} {:>8} {:>6} {:>6} {:>6} {:>6} {:>8} "
             "{:>6} {:>5}  {}\n",
             "scene", "vertices", "elements", "ccd", "dcd", "paths", "volumes", "trav.", "elem.", "step x iter",
             "avg s", "max s", "xpbd", "ccd", "dcd", "paths", "M con./s", "limit", "ns", "at the end");
}

void print_row(std::FILE* table, const std::string& name, const json& s) {
  const auto& step = s["average_per_step"];
  const auto& path = s["average_per_path"];
  const auto& share = s["shares"];
  const auto percent = [&](const char* part) { return 100 * share[part].get<double>(); };
  fmt::print(
      table,
      "{:<26} {:>9} {:>10} {:>8.1f} {:>8.1f} {:>8.1f} {:>7.1f} {:>6.2f} {:>6.2f} {:>12} {:>8.3f} {:>8.3f} "
      "{:>5.1f}% {:>5.1f}% {:>5.1f}% {:>5.1f}% {:>8.1f} {:>5.1f}% {:>5.0f}  {} penetrate by {:.2g} m, {} inverted{}\n",
      name, s["vertices"].get<std::int64_t>(), s["elements"].get<std::int64_t>(), step["ccd_contacts"].get<double>(),
      step["dcd_contacts"].get<double>(), step["path_queries"].get<double>(), path["volumes"].get<double>(),
      path["traversals"].get<double>(), path["elements"].get<double>(),
      fmt::format("{:.1e} x {}", s["time_step"].get<double>(), s["iterations"].get<int>()),
      s["frame_seconds"]["average"].get<double>(), s["frame_seconds"]["longest"].get<double>(), percent("material"),
      percent("ccd"), percent("dcd"), percent("paths"), 1e-6 * s.value("constraints_per_second", 0.0),
      100 * s.value("fraction_of_limit", 0.0), 1e9 * s.value("handover_seconds", 0.0),
      s["at_end"]["penetrating_vertices"].get<std::int64_t>(), s["at_end"]["deepest_penetration"].get<double>(),
      s["at_end"]["inverted_elements"].get<std::int64_t>(),
      s["outcome"] == "finished" ? "" : "; " + s["message"].get<std::string>());
  std::fflush(table);
}

/// The scene of many octopi with as many as are asked for.
Scene read_octopi(const SimulationPlan& plan, const std::array<int, 3>& counts) {
  std::ifstream file(plan.folder / kGrowing);
  json text = json::parse(file);
  text.erase("scales");
  text["bodies"][0]["instances"]["grid"]["counts"] = counts;
  text["colliders"][0]["box"]["max"] = {4.2 * counts[0] + 0.1, 4.2 * counts[1] + 0.1, 100};
  const Folder folder;
  fs::create_directories(folder.path());
  std::ofstream(folder.path() / kGrowing) << text;
  return read_scene(folder.path() / kGrowing);
}

void measure_growth(const SimulationPlan& plan, std::FILE* table, json& results) {
  fmt::print(table, "\n{:>8} {:>10} {:>12} {:>14}\n", "octopi", "elements", "ms a step", "ns an element");
  for (const std::array<int, 3>& counts : {std::array{1, 1, 1}, std::array{2, 1, 5}, std::array{5, 4, 5}}) {
    const Scene scene = read_octopi(plan, counts);
    json summary = run(scene, plan.frames > 0 ? plan.frames : kGrowthFrames, plan.threads);
    const double seconds = summary["seconds"]["steps"].get<double>() / summary["steps"].get<double>();
    const double elements = summary["elements"].get<double>();
    fmt::print(table, "{:>8} {:>10} {:>12.2f} {:>14.1f}\n", scene.model.bodies.size(), elements, 1e3 * seconds,
               1e9 * seconds / elements);
    std::fflush(table);
    results.push_back(std::move(summary));
  }
}

}  // namespace

void measure_simulation(const SimulationPlan& plan, std::FILE* table, const std::string& json_path) {
  if (!fs::is_directory(plan.folder))
    throw Error(plan.folder.string(), "is no folder of scenes", "name it by --scenes");
  const MachineLimit limit = LimitMeter(plan.threads, kLargeMemory).measure();
  fmt::print(table,
             "{} threads, at most {:.1f} G operations/s on doubles and {:.1f} GB/s of memory\n"
             "limit: what the material solve reaches of that; ns: a cache line from thread to thread, median\n\n",
             plan.threads, 1e-9 * limit.operations_per_second, 1e-9 * limit.bytes_per_second);
  print_head(table);
  json results = json::array(), growth = json::array();
  for (const std::string& name : names_of(plan)) {
    Scene scene = read_scene(plan.folder / (name + ".json"), plan.scale);
    for (const bool culling : {true, false}) {
      if (!culling && !plan.without_culling) continue;
      scene.options.contact.cull_infeasible_regions = culling;
      json summary = run(scene, plan.frames, plan.threads);
      summary["culling"] = culling;
      print_row(table, culling ? name : name + ", no culling", summary);
      results.push_back(std::move(summary));
    }
  }
  if (plan.growth) measure_growth(plan, table, growth);
  if (!json_path.empty())
    write_json_file(json_path, {{"schema", 1}, {"kind", "bench-simulation"}, {"runs", results}, {"growth", growth}});
}

}  // namespace selvage::bench
