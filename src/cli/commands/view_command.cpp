#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/output.h"
#include "page/mesh_page.h"
#include "page/result_page.h"
#include "page/run_page.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"

#include <fmt/format.h>

#include <memory>

namespace selvage::cli {

namespace {

namespace fs = std::filesystem;

struct ViewOptions {
  CommonOptions common;
  std::string result, output, after;
  std::int64_t every = 1;
  bool no_marks = false;
};

constexpr const char* kViewExample =
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi\n"
    "  selvage view octopi -o octopi.html\n"
    "  selvage check bent.vtu --json pairs.json\n"
    "  selvage view pairs.json -o pairs.html\n"
    "  selvage view bunny.obj -o bunny.html\n"
    "\n"
    "RESULT is the folder of a run, a mesh, or what check, paths or resolve wrote with --json. The page opens in "
    "Firefox "
    "and Chromium, needs no network and no other file, and can be sent as it is. See docs/guides/view.md.";

enum class ResultKind : std::uint8_t { kRun, kReport, kMesh };

ResultKind kind_of(const fs::path& path) {
  if (fs::is_directory(path)) return ResultKind::kRun;
  return path.extension() == ".json" ? ResultKind::kReport : ResultKind::kMesh;
}

/// Files that the page must not replace.
std::vector<fs::path> inputs_of(const ViewOptions& options, ResultKind kind) {
  std::vector<fs::path> inputs;
  if (kind == ResultKind::kMesh) inputs = files_of_mesh(options.result);
  if (kind == ResultKind::kReport) inputs = {options.result};
  if (kind == ResultKind::kRun) {
    const fs::path folder = options.result;
    inputs = {topology_path(folder),   rest_path(folder),         scene_path(folder),
              checkpoint_path(folder), folder / "statistics.csv", folder / "summary.json"};
  }
  if (!options.after.empty()) inputs.emplace_back(options.after);
  return inputs;
}

std::string print_page(const ViewOptions& options, ResultKind kind) {
  if (kind == ResultKind::kMesh) return print_mesh_page(options.result);
  if (kind == ResultKind::kReport) return print_result_page(options.result, options.after);
  ProgressBar progress("page", options.common.quiet);
  RunPageOptions page;
  page.every = options.every;
  page.marks = !options.no_marks;
  page.on_progress = [&](double share) { progress.show(share); };
  return print_run_page(options.result, page);
}

void run_view(const ViewOptions& options) {
  Stopwatch watch;
  const ResultKind kind = kind_of(options.result);
  OutputFiles outputs;
  const std::vector<fs::path> inputs = inputs_of(options, kind);
  outputs.expect(options.output, inputs);
  outputs.expect(options.common.json, inputs);
  const auto refuse_unless = [&](bool has_meaning, const char* option, const char* remedy) {
    if (!has_meaning) throw Error(option, fmt::format("has no meaning for {}", options.result), remedy);
  };
  refuse_unless(options.every == 1 || kind == ResultKind::kRun, "--every", "it leaves out frames of a run");
  refuse_unless(!options.no_marks || kind == ResultKind::kRun, "--no-marks", "it is for the folder of a run");
  refuse_unless(options.after.empty() || kind == ResultKind::kReport, "--after", "it is for what resolve wrote");
  const std::string page = print_page(options, kind);
  watch.lap("page");
  outputs.write_text(options.output, page);
  watch.lap("write");
  if (!options.common.json.empty())
    outputs.write_text(
        options.common.json,
        fmt::format("{{\"schema\": 1, \"kind\": \"view\", \"bytes\": {}, \"seconds\": {{\"total\": {}}}}}\n",
                    page.size(), watch.total()));
  outputs.commit();
  if (!options.common.quiet && !outputs.uses_standard_output())
    fmt::print("{}: {:.3g} MB in {}\n", options.output, static_cast<double>(page.size()) / 1e6,
               readable_seconds(watch.total()));
}

}  // namespace

Command add_view(CLI::App& app) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App* sub = add_subcommand(app, "view",
                                 "Writes one page for browsers that shows a run, a mesh or a result: to turn, to play, "
                                 "to cut open, to pick values from.",
                                 kViewExample);
  sub->add_option("result", options->result, "Folder of a run, JSON of check, paths or resolve, or a mesh")
      ->required()
      ->type_name("RESULT");
  sub->add_option("-o,--output", options->output, "The page; - is standard output")->required()->type_name("PAGE.html");
  sub->add_option("--every", options->every, "Of a run, show one frame in N, and the last")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}))
      ->type_name("N");
  sub->add_flag("--no-marks", options->no_marks,
                "Of a run, do not look for contacts, vertices inside and triangles that cross");
  sub->add_option("--after", options->after, "Of resolve, the mesh that it wrote, where it is no longer at its place")
      ->type_name("MESH");
  return {sub, &options->common, [options] {
            run_view(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
