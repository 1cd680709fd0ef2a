#include "cli/reports/run_report.h"

#include "core/isa.h"
#include "io/whole_file.h"
#include "page/run_page.h"
#include "selvage/scene/frames.h"
#include "selvage/version.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <ctime>
#include <fstream>
#include <thread>

namespace selvage::cli {

namespace {

/// Coordinates that a report holds at most: some hundred MB of page at the worst, a tenth of it usually.
constexpr std::int64_t kMaxCoordinates = 100'000'000;

/// The processor's name as Linux tells it.
std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) return line.substr(line.find(": ") + 2);
  return "unknown";
}

}  // namespace

void write_run_report(const std::filesystem::path& folder) {
  const FrameHeader last = read_checkpoint(checkpoint_path(folder)).header;
  RunPageOptions options;
  options.every = 1 + 3 * last.vertices * last.frame / kMaxCoordinates;
  const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  options.facts = {{"machine", "processor", processor_name()},
                   {"machine", "threads", fmt::format("{} of {}", threads, std::thread::hardware_concurrency())},
                   {"machine", "kernels", isa_name(active_isa())},
                   {"machine", "version", fmt::format("selvage {}", version())},
                   {"machine", "written", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::time(nullptr)))}};
  const std::string page = print_run_page(folder, options);
  write_whole_files(std::array{FileContent{folder / "report.html", page}});
}

}  // namespace selvage::cli
