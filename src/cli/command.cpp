#include "cli/command.h"

namespace selvage::cli {

CLI::App* add_subcommand(CLI::App& app, const std::string& name, const std::string& description,
                         const std::string& example, CommonOptions& common) {
  CLI::App* sub = app.add_subcommand(name, description);
  sub->footer("Example:\n" + example);
  sub->add_option("--threads", common.threads, "Number of threads; without it, all cores")
      ->check(CLI::Range(1, 4096))
      ->type_name("N");
  sub->add_flag("-q,--quiet", common.quiet, "Print nothing but errors");
  sub->add_option("--json", common.json, "Write the result as JSON; - is standard output")->type_name("FILE");
  return sub;
}

}  // namespace selvage::cli
