#pragma once

#include <filesystem>

namespace selvage::cli {

/// Writes report.html into the folder of a run: its page, with the machine, the version and the settings.
///
/// A run whose page would be longer than browsers open gets one with fewer frames.
/// @throws SystemError  when it cannot be written
void write_run_report(const std::filesystem::path& folder);

}  // namespace selvage::cli
