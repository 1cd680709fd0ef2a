#include "cli/program/command.h"
#include "cli/program/output.h"
#include "selvage/core/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

namespace selvage::cli {

namespace {

namespace fs = std::filesystem;

struct BenchOptions {
  CommonOptions common;
  std::vector<std::string> names;
  std::int64_t frames = 0;
  std::vector<std::string> scenes, runs;
  std::string scale;
  bool quick = false;
};

constexpr std::array kAll{"boundary-path", "self-collision", "simulation"};

/// The program with the measurements, beside this one or where a build tree has it.
std::optional<fs::path> find_bench_program() {
  const fs::path here = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& place : {here / "selvage_bench", here / "benchmarks" / "selvage_bench"}) {
    if (access(place.c_str(), X_OK) == 0) return place;
  }
  return std::nullopt;
}

/// Runs a program to its end; its exit status, or 128 and more where a signal ended it.
int run_program(const fs::path& program, std::vector<std::string> words, bool quiet) {
  words.insert(words.begin(), program.string());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (quiet) posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;  // this program ignores some signals, the other one need not
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  for (const int signal : {SIGPIPE, SIGXFSZ}) sigaddset(&defaults, signal);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  pid_t child = 0;
  const int error = posix_spawn(&child, program.c_str(), &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw Failure(fmt::format("{}: cannot be run ({})", program.string(), std::strerror(error)));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void run_bench(BenchOptions& options) {
  const auto program = find_bench_program();
  if (!program) {
    throw Error("bench", "the measurements are not built beside this program",
                "build them with `cmake --preset benchmark && cmake --build --preset benchmark` and run "
                "build/benchmark/selvage bench");
  }
  if (options.names.empty()) options.names.assign(kAll.begin(), kAll.end());
  const std::string& json = options.common.json;
  if (!json.empty() && options.names.size() > 1)
    throw Error("--json", "holds the result of one measurement", "name just one");
  OutputFiles outputs;
  outputs.expect(json);
  for (const std::string& name : options.names) {
    std::vector<std::string> words{name};
    if (options.common.threads > 0) words.insert(words.end(), {"--threads", std::to_string(options.common.threads)});
    if (options.quick) words.emplace_back("--quick");
    if (options.frames > 0 && name != "boundary-path")
      words.insert(words.end(), {"--frames", std::to_string(options.frames)});
    if (name == "self-collision")
      for (const std::string& run : options.runs) words.insert(words.end(), {"--run", run});
    if (name == "simulation") {
      for (const std::string& scene : options.scenes) words.insert(words.end(), {"--scene", scene});
      if (!options.scale.empty()) words.insert(words.end(), {"--scale", options.scale});
    }
    if (!json.empty()) words.insert(words.end(), {"--json", json == "-" ? json : outputs.stage(json).string()});
    const int status = run_program(*program, words, options.common.quiet && json != "-");
    if (status != 0) throw Failure(fmt::format("bench {}: ended with status {}", name, status));
  }
  outputs.commit();
}

}  // namespace

Command add_bench(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* sub = add_subcommand(app, "bench", "Runs the measurements behind the figures in the docs.",
                                 "  selvage bench boundary-path --quick --threads 1 --json bench.json\n"
                                 "  selvage bench simulation --frames 3");
  sub->add_option("names", options->names,
                  fmt::format("Measurements to run: any of {}; all by default", fmt::join(kAll, ", ")))
      ->check(CLI::IsMember(std::vector<std::string>(kAll.begin(), kAll.end())))
      ->type_name("NAME");
  sub->add_flag("--quick", options->quick, "Small meshes and few rounds: a quick check");
  sub->add_option("--frames", options->frames, "Frames of each sequence or scene; by default all of them")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{100'000}))
      ->type_name("N");
  sub->add_option("--run", options->runs, "self-collision: the frames of simulated runs, by their folders")
      ->check(CLI::ExistingDirectory)
      ->type_name("FOLDER");
  sub->add_option("--scene", options->scenes, "simulation: only these scenes")->type_name("NAME");
  sub->add_option("--scale", options->scale, "simulation: a scale of the scenes, such as paper")->type_name("NAME");
  return {sub, &options->common, [options] {
            run_bench(*options);
            return kDone;
          }};
}

}  // namespace selvage::cli
