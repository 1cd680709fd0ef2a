#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/output.h"
#include "export/export_run.h"
#include "selvage/core/error.h"
#include "selvage/scene/frames.h"

#include <fmt/format.h>

#include <memory>

namespace selvage::cli {

namespace {

struct ExportOptions {
  CommonOptions common;
  std::string run, output;
  std::int64_t every = 1;
};

constexpr const char* kExportExample =
    "  selvage simulate scenes/octopi_8_hybrid.json -o octopi\n"
    "  selvage export octopi -o octopi.usda\n"
    "\n"
    "The boundary of all bodies is one mesh, and its vertices are those of the boundary in ascending order. In metres, "
    "z upwards.\n"
    "  .pc2   points for the mesh of a .obj that is written beside it\n"
    "  .glb   glTF 2.0: a morph target a frame\n"
    "  .usda  USD: time samples of the points\n"
    "See docs/guides/blender.md.";

void run_export(const ExportOptions& options) {
  OutputFiles outputs;
  if (options.output == "-") throw Error("-o", "a run is not exported to standard output", "name a file");
  for (const auto& path : files_of_export(options.output))
    outputs.expect(path.string(), {topology_path(options.run), checkpoint_path(options.run)});
  outputs.expect(options.common.json);
  Stopwatch watch;
  std::size_t size = 0;
  for (const ExportedFile& file : export_run(options.run, options.output, options.every)) {
    outputs.write_text(file.path.string(), file.bytes);
    size += file.bytes.size();
  }
  watch.lap("export");
  if (!options.common.json.empty())
    outputs.write_text(
        options.common.json,
        fmt::format("{{\"schema\": 1, \"kind\": \"export\", \"bytes\": {}, \"seconds\": {{\"total\": {}}}}}\n", size,
                    watch.total()));
  outputs.commit();
  if (!options.common.quiet && !outputs.uses_standard_output())
    fmt::print("{}: {:.3g} MB in {}\n", options.output, static_cast<double>(size) / 1e6,
               readable_seconds(watch.total()));
}

}  // namespace

Command add_export(CLI::App& app) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* sub = add_subcommand(app, "export", "Writes a run in a format of other programs: PC2 with OBJ, glTF, USD.",
                                 kExportExample);
  sub->add_option("run", options->run, "Folder of the run")->required()->type_name("RUN");
  sub->add_option("-o,--output", options->output, "The file; its extension tells the format")
      ->required()
      ->type_name("FILE");
  sub->add_option("--every", options->every, "Write one frame in N, and the last")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}))
      ->type_name("N");
  return {sub, &options->common, [options] {
            run_export(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
