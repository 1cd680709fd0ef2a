#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/output.h"
#include "cli/reports/run_report.h"
#include "selvage/core/error.h"
#include "selvage/scene/run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace selvage::cli {

namespace {

struct SimulateOptions {
  CommonOptions common;
  std::string scene, scale, folder, surface;
  std::vector<std::string> changes;
  std::int64_t frames = -1, check_every = 0;
  bool resume = false, vtu = false, no_report = false;
};

constexpr const char* kSimulateExample =
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi --vtu\n"
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi --resume --frames 400\n"
    "  selvage simulate scenes/long_noodle.json -o run --set /bodies/0/mesh/length=3\n"
    "\n"
    "The folder holds, after each frame:\n"
    "  frames/frame_000012.bin  positions, after a header of 64 bytes:\n"
    "                           numpy.fromfile(name, '<f4', offset=64).reshape(-1, 3)\n"
    "  topology.bin             elements, body of each vertex, boundary faces\n"
    "  statistics.csv           per frame: contacts, paths, penetration, seconds\n"
    "  checkpoint.bin           the state that --resume continues from\n"
    "and at the end summary.json and report.html, a page for browsers that shows the run. Scenes and files are "
    "explained in docs/guides/simulate.md.";

/// How many a minute, in at most three digits where they are few.
std::string per_minute(double count, double seconds) {
  const double pace = 60 * count / seconds;
  return pace < 100 ? fmt::format("{:.2g}", pace) : grouped(std::llround(pace));
}

std::string count_text(std::int64_t count, const char* one, const char* many) {
  return fmt::format("{} {}", grouped(count), count == 1 ? one : many);
}

const char* name_of(StepProgress::Phase phase) {
  switch (phase) {
    case StepProgress::Phase::kMaterial:
      return "material";
    case StepProgress::Phase::kFindingContacts:
      return "finding contacts";
    case StepProgress::Phase::kProjection:
      return "projecting contacts";
    default:
      return "holding back";
  }
}

/// A frame that takes longer says what it is busy with [s].
constexpr double kLongFrame = 2;

/// Frames per minute and what is left, while the run goes on; in a long frame its step.
class FrameProgress {
 public:
  FrameProgress(std::int64_t last, bool quiet) : bar_("frame", quiet), last_(last) {}

  void show(std::int64_t frame) {
    if (first_ < 0) {
      first_ = frame;
      start_ = Clock::now();
    }
    frame_start_ = Clock::now();
    const double seconds = seconds_since(start_);
    const auto done = static_cast<double>(frame - first_), left = static_cast<double>(last_ - frame);
    std::string note = fmt::format("{} of {}", frame, last_);
    if (done > 0) note += fmt::format(", {} a minute", per_minute(done, seconds));
    if (done > 0 && left > 0) note += fmt::format(", {} left", readable_duration(left * seconds / done));
    show(frame, note);
  }
  void show_step(const StepProgress& step) {
    if (first_ >= 0 && seconds_since(frame_start_) > kLongFrame)
      show(step.frame - 1,
           fmt::format("{} of {}, step {} of {}: {}", step.frame, last_, step.step, step.steps, name_of(step.phase)));
  }
  void show_start(const std::string& body, const ResolveIteration& iteration) {
    if (seconds_since(frame_start_) > kLongFrame)
      show(0, fmt::format("start of '{}', iteration {}: {} of the boundary cross", body, iteration.iteration,
                          count_text(iteration.triangle_pairs, "pair", "pairs")));
  }
  void clear() { bar_.clear(); }

 private:
  using Clock = std::chrono::steady_clock;
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
  void show(std::int64_t frame, const std::string& note) {
    bar_.show(last_ > 0 ? static_cast<double>(frame) / static_cast<double>(last_) : 1, note);
  }

  ProgressBar bar_;
  std::int64_t last_, first_ = -1;
  Clock::time_point start_, frame_start_;
};

/// Says before the first frame that bodies overlap, or cloth crosses: the figures at the end do not tell what the scene
/// began with. And after it what was brought out.
void print_start(const FrameStatistics& row) {
  if (row.resolved_bodies > 0)
    fmt::print("before frame 1   {} brought out, {}\n",
               count_text(row.resolved_bodies, "body tangled in itself", "bodies tangled in themselves"),
               readable_duration(row.seconds_start));
  if (row.frame > 0) return;
  if (row.penetrating_vertices > 0)
    fmt::print("at the start     {} inside bodies, at most {:.3g} mm deep\n",
               count_text(row.penetrating_vertices, "vertex", "vertices"), 1e3 * row.deepest_penetration);
  else if (row.triangle_pairs > 0)
    fmt::print("at the start     {}\n",
               count_text(row.triangle_pairs, "pair of triangles crosses", "pairs of triangles cross"));
  std::fflush(stdout);
}

std::string depth_text(double depth) {
  return depth < 0.1 ? fmt::format("{:.3g} mm", 1e3 * depth) : fmt::format("{:.3g} m", depth);
}

/// Crossings in one line: "free" where nothing crosses.
std::string crossings_text(const Crossings& crossings) {
  if (!crossings.any()) return "free";
  std::vector<std::string> parts;
  const BodyPairCrossings& bodies = crossings.bodies.total;
  if (bodies.triangle_pairs > 0)
    parts.push_back(count_text(bodies.triangle_pairs, "pair of triangles crosses", "pairs of triangles cross"));
  if (bodies.vertices > 0)
    parts.push_back(fmt::format("{} inside, deepest {}", count_text(bodies.vertices, "vertex", "vertices"),
                                depth_text(bodies.deepest_vertex)));
  if (bodies.edges > 0)
    parts.push_back(
        fmt::format("{}, deepest {}", count_text(bodies.edges, "edge", "edges"), depth_text(bodies.deepest_edge)));
  ColliderCrossings all;
  for (const ColliderCrossings& collider : crossings.colliders) all.add(collider);
  if (all.any())
    parts.push_back(fmt::format("in colliders {}", depth_text(std::max(all.deepest_vertex, all.deepest_point))));
  return fmt::format("{}", fmt::join(parts, "; "));
}

/// Crossing pairs of triangles, and the two bodies that have most of them.
std::string triangle_pairs_text(const Scene& scene, const BodyCrossings& crossings) {
  if (crossings.total.triangle_pairs == 0) return "none at the end";
  std::string text = count_text(crossings.total.triangle_pairs, "pair at the end", "pairs at the end");
  const BodyPairCrossings& most = *std::ranges::max_element(crossings.pairs, {}, &BodyPairCrossings::triangle_pairs);
  const auto name = [&](Index body) { return scene.model.bodies[static_cast<std::size_t>(body)].name; };
  if (scene.model.bodies.size() > 1)
    text += fmt::format(", {} in '{}' and '{}'", grouped(most.triangle_pairs), name(most.first), name(most.second));
  return text;
}

/// Rows that say what stands in what at the end; those about edges and colliders only where they say something.
void add_crossings(const Scene& scene, const Crossings& crossings, Table& table) {
  const BodyPairCrossings& bodies = crossings.bodies.total;
  const auto inside = [](std::int64_t count, double depth) {
    return count == 0 ? std::string("none at the end")
                      : fmt::format("{} at the end, deepest {}", grouped(count), depth_text(depth));
  };
  table.add("penetrating vertices", inside(bodies.vertices, bodies.deepest_vertex));
  if (bodies.edges > 0) table.add("penetrating edges", inside(bodies.edges, bodies.deepest_edge));
  table.add("crossing triangles", triangle_pairs_text(scene, crossings.bodies));
  ColliderCrossings all;
  for (const ColliderCrossings& collider : crossings.colliders) all.add(collider);
  if (all.vertices > 0) table.add("vertices in colliders", inside(all.vertices, all.deepest_vertex));
  if (all.points > 0) table.add("colliders in bodies", inside(all.points, all.deepest_point));
}

/// How the steps were solved; of the implicit solvers with what is left.
std::string solver_text(const Scene& scene, const RunReport& report) {
  if (scene.solver == SolverKind::kXpbd) return fmt::format("{} iterations each", scene.options.iterations);
  std::int64_t count = 0;
  double residual = 0;
  for (const FrameStatistics& row : report.frames) {
    count += row.newton_steps;
    residual = std::max(residual, row.residual);
  }
  const auto steps = static_cast<double>(std::max<std::int64_t>(report.frames.back().steps, 1));
  return fmt::format("{:.3g} {} each, largest residual {:.3g} m", static_cast<double>(count) / steps,
                     scene.solver == SolverKind::kNewton ? "Newton steps" : "sweeps", residual);
}

/// Since when nothing can have met, and what that took.
std::string guarantee_text(const RunReport& report) {
  const std::optional<std::int64_t> from = guaranteed_from(report.frames);
  if (!from) return "of nothing: bodies still penetrate";
  std::int64_t held_back = 0;
  for (const FrameStatistics& row : report.frames) held_back += row.held_back_vertices;
  return fmt::format("nothing meets from frame {} on; {} held back", *from,
                     count_text(held_back, "vertex was", "vertices were"));
}

void print_summary(const SimulateOptions& options, const Scene& scene, const RunReport& report, double seconds) {
  const FrameStatistics& last = report.frames.back();
  const std::int64_t run = last.frame - report.first_frame;
  Table table;
  const auto triangles = std::ssize(scene.model.triangles);
  table.add("scene", fmt::format("{}{}{}, {} {}, {} vertices, {} tetrahedra{}", scene.name,
                                 scene.scale.empty() ? "" : " at scale ", scene.scale, scene.model.bodies.size(),
                                 scene.model.bodies.size() == 1 ? "body" : "bodies",
                                 grouped(scene.model.mesh.vertex_count()), grouped(scene.model.mesh.element_count()),
                                 triangles > 0 ? fmt::format(", {} triangles of cloth", grouped(triangles)) : ""));
  table.add("frames", report.first_frame > 0
                          ? fmt::format("{}, {} of them now, continued from {}", last.frame, run, report.first_frame)
                          : fmt::format("{}", last.frame));
  std::int64_t halved = 0;
  for (const FrameStatistics& row : report.frames) halved += row.halved_steps;
  table.add("steps",
            fmt::format("{} of {:.3g} s{}, {}", grouped(last.steps), scene.options.time_step,
                        halved > 0 ? fmt::format(" ({} halved)", grouped(halved)) : "", solver_text(scene, report)));
  if (scene.options.contact.guarantee) table.add("guarantee", guarantee_text(report));
  add_crossings(scene, report.crossings, table);
  table.add("inverted elements", grouped(last.inverted_elements));
  if (last.flat_elements > 0) table.add("flat elements", grouped(last.flat_elements));
  table.add("fastest vertex", fmt::format("{:.3g} m/s", last.fastest));
  table.add("time", run > 0 ? fmt::format("{}, {} frames a minute", readable_duration(seconds),
                                          per_minute(static_cast<double>(run), seconds))
                            : readable_duration(seconds));
  table.add("files", options.folder);
  table.print();
}

RunOptions run_options(const SimulateOptions& options) {
  RunOptions run;
  run.folder = options.folder;
  if (options.frames >= 0) run.frames = options.frames;
  run.resume = options.resume;
  run.check_every = options.check_every;
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
  const Scene scene = read_scene(options.scene, options.scale, options.changes);
  RunOptions run = run_options(options);
  FrameProgress progress(run.frames.value_or(scene.frames), options.common.quiet);
  const bool prints = !options.common.quiet && !outputs.uses_standard_output();
  run.on_frame = [&](const FrameStatistics& row) {
    if (prints && row.resolved_bodies > 0) progress.clear();
    if (prints) print_start(row);
    progress.show(row.frame);
  };
  run.on_step = [&](const StepProgress& step) { progress.show_step(step); };
  run.on_start = [&](const StartProgress& start) {
    progress.show_start(scene.model.bodies[static_cast<std::size_t>(start.body)].name, start.iteration);
  };
  if (prints)
    run.on_check = [&](std::int64_t frame, const Crossings& crossings) {
      progress.clear();
      fmt::print("frame {:<10} {}\n", frame, crossings_text(crossings));
      std::fflush(stdout);
    };
  watch.lap("read");
  const RunReport report = run_scene(scene, run);
  watch.lap("run");
  progress.clear();
  if (!options.no_report) write_run_report(options.folder);
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
  sub->add_option("--set", options->changes,
                  "Use another value than the scene's: its place as a JSON pointer, and JSON or a text; may be given "
                  "several times, and comes after --scale")
      ->take_all()
      ->expected(1)
      ->type_name("/PLACE=VALUE");
  sub->add_option("--check-every", options->check_every,
                  "Say every N frames what crosses, and write it by pairs of bodies to checks/frame_*.json")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}))
      ->type_name("N");
  sub->add_flag("--vtu", options->vtu, "Also write vtu/frame_*.vtu and frames.pvd, for ParaView");
  sub->add_option("--surface", options->surface, "Also write the boundary: surface/frame_*.ply or .obj")
      ->check(CLI::IsMember({"ply", "obj"}))
      ->type_name("FORMAT");
  sub->add_flag("--no-report", options->no_report, "Do not write report.html");
  return {sub, &options->common, [options] {
            run_simulate(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
