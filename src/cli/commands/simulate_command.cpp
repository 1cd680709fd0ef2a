#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/output.h"
#include "selvage/core/error.h"
#include "selvage/scene/run.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace selvage::cli {

namespace {

struct SimulateOptions {
  CommonOptions common;
  std::string scene, scale, folder, surface;
  std::int64_t frames = -1;
  bool resume = false, vtu = false;
};

constexpr const char* kSimulateExample =
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi --vtu\n"
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi --resume --frames 120\n"
    "\n"
    "The folder holds, after each frame:\n"
    "  frames/frame_000012.bin  positions, after a header of 64 bytes:\n"
    "                           numpy.fromfile(name, '<f4', offset=64).reshape(-1, 3)\n"
    "  topology.bin             elements, body of each vertex, boundary faces\n"
    "  statistics.csv           per frame: contacts, paths, penetration, seconds\n"
    "  checkpoint.bin           the state that --resume continues from\n"
    "and at the end summary.json. Scenes and files are explained in docs/guides/simulate.md.";

std::string frames_a_minute(double frames, double seconds) {
  const double pace = 60 * frames / seconds;
  return pace < 100 ? fmt::format("{:.2g} frames a minute", pace)
                    : fmt::format("{} frames a minute", grouped(std::llround(pace)));
}

/// Frames per minute and what is left, while the run goes on.
class FrameProgress {
 public:
  FrameProgress(std::int64_t last, bool quiet) : bar_("frame", quiet), last_(last) {}

  void show(std::int64_t frame) {
    if (first_ < 0) {
      first_ = frame;
      start_ = Clock::now();
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    const auto done = static_cast<double>(frame - first_), left = static_cast<double>(last_ - frame);
    std::string note = fmt::format("{} of {}", frame, last_);
    if (done > 0)
      note += fmt::format(", {}, {} left", frames_a_minute(done, seconds), readable_duration(left * seconds / done));
    bar_.show(last_ > 0 ? static_cast<double>(frame) / static_cast<double>(last_) : 1, note);
  }
  void clear() { bar_.clear(); }

 private:
  using Clock = std::chrono::steady_clock;
  ProgressBar bar_;
  std::int64_t last_, first_ = -1;
  Clock::time_point start_;
};

/// Says before the first frame that bodies overlap: the figures at the end do not tell what the scene began with.
void print_start(const FrameStatistics& row) {
  if (row.frame > 0 || row.penetrating_vertices == 0) return;
  fmt::print("at the start     {} {} inside bodies, at most {:.3g} mm deep\n", grouped(row.penetrating_vertices),
             row.penetrating_vertices == 1 ? "vertex" : "vertices", 1e3 * row.deepest_penetration);
  std::fflush(stdout);
}

void print_summary(const SimulateOptions& options, const Scene& scene, const RunReport& report, double seconds) {
  const FrameStatistics& last = report.frames.back();
  const std::int64_t run = last.frame - report.first_frame;
  Table table;
  table.add("scene", fmt::format("{}{}{}, {} {}, {} vertices, {} tetrahedra", scene.name,
                                 scene.scale.empty() ? "" : " at scale ", scene.scale, scene.model.bodies.size(),
                                 scene.model.bodies.size() == 1 ? "body" : "bodies",
                                 grouped(scene.model.mesh.vertex_count()), grouped(scene.model.mesh.element_count())));
  table.add("frames", report.first_frame > 0
                          ? fmt::format("{}, {} of them now, continued from {}", last.frame, run, report.first_frame)
                          : fmt::format("{}", last.frame));
  table.add("steps", fmt::format("{} of {:.3g} s, {} iterations each", grouped(last.steps), scene.options.time_step,
                                 scene.options.iterations));
  table.add("penetrating vertices", last.penetrating_vertices == 0
                                        ? std::string("none at the end")
                                        : fmt::format("{} at the end, deepest {:.3g} m",
                                                      grouped(last.penetrating_vertices), last.deepest_penetration));
  table.add("crossing triangles", last.triangle_pairs == 0
                                      ? std::string("none at the end")
                                      : fmt::format("{} {} at the end", grouped(last.triangle_pairs),
                                                    last.triangle_pairs == 1 ? "pair" : "pairs"));
  table.add("inverted elements", grouped(last.inverted_elements));
  if (last.flat_elements > 0) table.add("flat elements", grouped(last.flat_elements));
  table.add("fastest vertex", fmt::format("{:.3g} m/s", last.fastest));
  table.add("time", run > 0 ? fmt::format("{}, {}", readable_duration(seconds),
                                          frames_a_minute(static_cast<double>(run), seconds))
                            : readable_duration(seconds));
  table.add("files", options.folder);
  table.print();
}

RunOptions run_options(const SimulateOptions& options) {
  RunOptions run;
  run.folder = options.folder;
  if (options.frames >= 0) run.frames = options.frames;
  run.resume = options.resume;
  run.vtu = options.vtu;
  if (options.surface == "ply") run.surface = SurfaceFormat::kPly;
  if (options.surface == "obj") run.surface = SurfaceFormat::kObj;
  return run;
}

void run_simulate(const SimulateOptions& options) {
  Stopwatch watch;
  OutputFiles outputs;
  outputs.expect(options.common.json, {options.scene});
  if (std::filesystem::exists(options.folder) && !std::filesystem::is_directory(options.folder))
    throw Error(options.folder, "is a file", "name a folder for the run");
  const Scene scene = read_scene(options.scene, options.scale);
  RunOptions run = run_options(options);
  FrameProgress progress(run.frames.value_or(scene.frames), options.common.quiet);
  const bool prints = !options.common.quiet && !outputs.uses_standard_output();
  run.on_frame = [&](const FrameStatistics& row) {
    if (prints) print_start(row);
    progress.show(row.frame);
  };
  watch.lap("read");
  const RunReport report = run_scene(scene, run);
  watch.lap("run");
  progress.clear();
  outputs.write_text(options.common.json, summarize_run(scene, report));
  outputs.commit();
  if (prints) print_summary(options, scene, report, watch.laps().back().second);
  if (report.outcome != RunOutcome::kFinished) throw Failure(fmt::format("{}: {}", options.scene, report.message));
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  CLI::App* sub =
      add_subcommand(app, "simulate",
                     "Runs a scene of deformable bodies that touch themselves and one another. A run that "
                     "was stopped is continued with --resume, and gives the same frames as without the stop.",
                     kSimulateExample);
  sub->add_option("scene", options->scene, "Scene file")->required()->type_name("SCENE.json");
  sub->add_option("-o,--output", options->folder, "Folder of the run; made if it is not there")
      ->required()
      ->type_name("DIR");
  sub->add_option("--frames", options->frames, "Number of frames in place of the scene's; with --resume the total")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000}))
      ->type_name("N");
  sub->add_flag("--resume", options->resume, "Continue the run in the folder from its last frame, if it has one");
  sub->add_option("--scale", options->scale, "A scale of the scene, such as paper")->type_name("NAME");
  sub->add_flag("--vtu", options->vtu, "Also write vtu/frame_*.vtu and frames.pvd, for ParaView");
  sub->add_option("--surface", options->surface, "Also write the boundary: surface/frame_*.ply or .obj")
      ->check(CLI::IsMember({"ply", "obj"}))
      ->type_name("FORMAT");
  return {sub, &options->common, [options] {
            run_simulate(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
