#include "cli/program/command.h"

namespace selvage::cli {

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& example) {
  CLI::App* sub = app.add_subcommand(name, description);
  sub->group("Commands");
  sub->footer("Example:\n" + example);
  sub->set_help_flag();
  return sub;
}

void add_common_options(const Command& command) {
  const char* const group = "Options of every command";
  CLI::App& sub = *command.app;
  CommonOptions& common = *command.common;
  sub.add_option("--json", common.json, "Write the result as JSON; - is standard output")
      ->type_name("FILE")
      ->group(group);
  sub.add_option("--threads", common.threads, "Number of threads; without it, all cores")
      ->check(CLI::Range(1, 4096))
      ->type_name("N")
      ->group(group);
  sub.add_flag("-q,--quiet", common.quiet, "Print nothing but errors")->group(group);
  sub.set_help_flag("-h,--help", "Print this help")->group(group);
}

}  // namespace selvage::cli
