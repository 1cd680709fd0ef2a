#include "cli/program/command.h"
#include "cli/program/console.h"
#include "cli/program/help.h"
#include "cli/program/output.h"
#include "selvage/core/error.h"
#include "selvage/version.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <string>

namespace selvage::cli {

namespace {

/// Reports an error in one line, whatever the message holds.
int report(std::string message, int status) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fputs(fmt::format("selvage: {}\n", message).c_str(), stderr);  // which may be closed
  return status;
}

/// Makes readers that have gone away, limits of file sizes and closed standard streams errors of writing like any
/// other: nothing ends the program before its temporary files are removed, and no file that it opens takes a stream's
/// place.
void secure_outputs() {
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (const int end : {SIGINT, SIGTERM, SIGHUP}) {
    if (std::signal(end, end_without_staged_files) == SIG_IGN) std::signal(end, SIG_IGN);  // as under nohup
  }
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    // Opened for reading, which makes writing fail.
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

int run_command(const Command& command) {
  try {
    const int threads = command.common->threads;
    const int all = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads > 0 ? threads : all);
    const int status = command.run();
    if (std::fflush(stdout) != 0) return report("cannot write to standard output", kFailed);
    return status;
  } catch (const Failure& error) {
    return report(error.what(), kFailed);
  } catch (const SystemError& error) {
    return report(error.what(), kFailed);
  } catch (const Error& error) {
    return report(error.what(), kBadInput);
  } catch (const std::bad_alloc&) {
    return report("not enough memory", kFailed);
  } catch (const std::exception& error) {
    return report(error.what(), kFailed);
  }
}

}  // namespace

int run_program(int argc, char** argv) {
  CLI::App app("selvage finds and resolves the self-collisions of deformable meshes, exactly and fast.", "selvage");
  app.formatter(std::make_shared<HelpFormatter>(std::clamp(terminal_width(STDOUT_FILENO, 80), 30, 100)));
  app.set_help_flag("-h,--help", "Print this help");
  app.set_version_flag("--version", std::string("selvage ") + version(), "Print the version");
  app.require_subcommand(1);
  app.footer(
      "`selvage COMMAND --help` explains a command and shows an example.\n"
      "Exit status: 0 done, 1 done and `check` found collisions, 2 bad usage or bad input, 3 the computation failed.");
  const std::array commands{add_info(app),     add_make(app), add_check(app),  add_paths(app),  add_resolve(app),
                            add_simulate(app), add_view(app), add_render(app), add_export(app), add_bench(app)};
  for (const Command& command : commands) add_common_options(command);
  try {
    std::vector<std::string> words = words_of_help(app, {argv + std::min(argc, 1), argv + argc});
    std::reverse(words.begin(), words.end());  // as CLI11 wants them
    app.parse(std::move(words));
  } catch (const CLI::Success& success) {
    app.exit(success);
    return std::cout.flush() ? kDone : report("cannot write to standard output", kFailed);
  } catch (const CLI::ParseError& error) {
    const auto parsed = app.get_subcommands();
    const std::string help = parsed.empty() ? "selvage --help" : "selvage " + parsed[0]->get_name() + " --help";
    return report(fmt::format("{}; see `{}`", explain(app, error), help), kBadInput);
  }
  const auto chosen = std::find_if(commands.begin(), commands.end(), [](const Command& c) { return c.app->parsed(); });
  return run_command(*chosen);
}

}  // namespace selvage::cli

int main(int argc, char** argv) {
  selvage::cli::secure_outputs();
  return selvage::cli::run_program(argc, argv);
}
