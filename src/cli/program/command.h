#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <stdexcept>
#include <string>

namespace selvage::cli {

/// Exit statuses of the program; kCollisions says `check` alone: done, and there are some.
enum ExitStatus : int { kDone = 0, kCollisions = 1, kBadInput = 2, kFailed = 3 };

/// Raised where the computation fails for no fault of the input: a full disk, say.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Options of every subcommand.
struct CommonOptions {
  int threads = 0;  ///< 0: all cores
  bool quiet = false;
  std::string json;  ///< file of the machine-readable result; "-": standard output; empty: none
};

/// A subcommand that has been declared; `run` is called after the arguments were read, and gives the exit status.
struct Command {
  CLI::App* app;
  CommonOptions* common;
  std::function<int()> run;
};

/// Declares a subcommand.
///
/// @param example  command lines shown at the end of the help, and what is to be said of them
CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& example);

/// Declares what all subcommands have in common; after a subcommand's own options, and so behind them in the help.
void add_common_options(const Command& command);

Command add_info(CLI::App& app);
Command add_make(CLI::App& app);
Command add_check(CLI::App& app);
Command add_paths(CLI::App& app);
Command add_resolve(CLI::App& app);
Command add_simulate(CLI::App& app);
Command add_view(CLI::App& app);
Command add_render(CLI::App& app);
Command add_export(CLI::App& app);
Command add_bench(CLI::App& app);

}  // namespace selvage::cli
